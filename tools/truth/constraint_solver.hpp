#pragma once

#include <cstdint>
#include <vector>

#include "truth/model.hpp"
#include "truth/pivoted_cholesky.hpp"
#include "truth/spanning_tree.hpp"

namespace plumb::truth {

/// Solves for the accelerations and multipliers of a configuration, exactly but for rounding:
///
///   M a - J^T mu = f,   J a = c
///
/// J has a row for every rigid rod. Elastic rods count only by their mass, and their pulls belong to f.
///
/// A spanning tree of rods is eliminated leaf to root in O(n), with a 3×3 block and a multiplier for each
/// particle. Several fixed particles do not matter, since the tree has only one of the rods that tie a
/// connected part to them. The rods left over are the chords, which close loops (through the ground as well).
/// They become rows of a small dense system, the tree's inverse seen through them. A row whose pivot vanishes
/// says nothing that the others do not. It is left out, which leaves the accelerations the same.
///
/// A chord whose mass couples its ends would spoil the tree's mass matrix. It is hung into the tree by its a,
/// with a copy of its b, and three rows weld copy and b together.
class ConstraintSolver {
 public:
  /// Throws Unreachable if more than `most_rows` rows are needed. The model must outlive the solver.
  explicit ConstraintSolver(const Model& model);
  static constexpr std::size_t most_rows = 1024;

  /// Prepares solve() for these positions. It costs O(n), and with k rows O(n k + k³/3). Throws Unreachable
  /// if the mass matrix is not positive definite.
  void factor(const std::vector<Point>& x);

  /// Solves for a in m/s², 0 where fixed, and mu in N/m, 0 for redundant and elastic rods. `f` is in N,
  /// one for each particle, and `c` in m²/s², one for each rod. Those of elastic rods are not read. Both
  /// results must have the model's size. It costs O(n), and with k rows O(n + k²).
  void solve(const std::vector<Point>& f, const std::vector<Real>& c, std::vector<Point>& a,
             std::vector<Real>& mu);

  std::size_t rows() const { return rows_.size(); }
  /// Returns the rows left out at the last factor(), because the others imply them.
  std::size_t redundant() const { return dense_.dependent().size(); }

 private:
  struct Node : TreeNode {
    bool passes_up = false;  ///< Whether the parent is movable.
    Real coupling = 0;       ///< Coupling of the two by the rod's mass, in kg.
    Point d{};               ///< Vector from the parent, in m.
    Factor3 factor{};        ///< Factor of the mass felt here, in kg, with all that hangs below.
    Point u{};               ///< The inverse of that mass times d.
    Point e{};               ///< The sum d + coupling u.
    Real sigma = 0;          ///< The product d·u; infinite for an elastic rod, whose mu is 0.
    Point q{};               ///< Scratch of a solve: the motion if the parent stood still.
    Real s = 0;              ///< Scratch of a solve: the multiplier then.
  };
  /// A row says d·(a_b - a_a) = c of the rod, or 0 for a weld.
  struct Row {
    std::uint32_t a = 0, b = 0;
    std::uint32_t rod = no_rod;
    Point d{};
  };

  void add_node(const TreeNode& node);
  void factor_tree(const std::vector<Point>& x);
  void factor_rows();
  void solve_tree(const std::vector<Real>& c);

  const Model& model_;
  std::vector<Real> mass_;  ///< Masses of particles and then of copies, in kg.
  std::vector<char> fixed_;
  std::vector<std::uint32_t> copied_;  ///< The particle that each copy is of.
  std::vector<Node> nodes_;            ///< Nodes, with every parent before its children.
  std::vector<Row> rows_;
  PivotedCholesky dense_;
  // Scratch holds particles and then copies.
  std::vector<Symmetric> felt_;
  std::vector<Point> pull_, motion_;
  std::vector<Real> push_, right_;
};

}  // namespace plumb::truth
