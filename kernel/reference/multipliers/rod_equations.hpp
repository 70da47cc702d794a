#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <memory>
#include <optional>
#include <utility>

#include "plumb/layouts/memory.hpp"
#include "plumb/layouts/trees.hpp"
#include "plumb/scene.hpp"
#include "reference/multipliers/refinement.hpp"

namespace plumb::detail {

/// Takes the movable particles of an island as nodes, and its rods as rows of the constraint Jacobian J
/// (thesis §3.1.7). With d_r = x_a - x_b, row r is d_r on the columns of node a and -d_r on those of node b.
/// The mass matrix M has a number per node, and couples the two ends of rods whose mass is consistent.
struct RodEquations {
  static constexpr std::uint32_t none = 0xffffffff;

  struct Row {
    std::uint32_t a;      ///< Node at one end.
    std::uint32_t b;      ///< Node at the other end, or `none` if it is an anchor.
    std::uint32_t fixed;  ///< The island's number of that anchor, where there is one.
    std::uint32_t rod;    ///< The island's number of the rod.
    double coupling;      ///< Entry of the mass matrix between the two ends, in kg.
    double length2;       ///< Squared rest length, in m².
    double compliance;    ///< Softening of the row per m² of its length, in 1/kg; 0 is rigid.
  };

  Array<std::uint32_t> particle;  ///< The island's number of every node.
  Array<double> mass;             ///< Diagonal of M by node, in kg.
  Array<Row> rows;  ///< Each rod is a row. On a tree row i - 1 is the rod of node i to its parent; rods
                    ///< to anchors follow.
  std::optional<layouts::Tree> tree;
  bool softened = false;  ///< Says whether rows may be redundant. They then have a compliance, which
                          ///< refinement takes out.

  Eigen::Index unknowns() const { return 3 * static_cast<Eigen::Index>(mass.size()); }
};
RodEquations make_rod_equations(const Scene& island, MassModel model);

/// Solves M x - Jᵀ lambda = f, J x + S lambda = c, with S the compliances. lambda has a number per row.
class RodFactor {
 public:
  virtual ~RodFactor() = default;
  /// Factorises the matrix; `directions` holds d of every row.
  virtual void factorize(const Array<Vec3>& directions) = 0;
  virtual void solve(const Eigen::VectorXd& f, const Eigen::VectorXd& c, Eigen::VectorXd& x,
                     Eigen::VectorXd& lambda) = 0;
};

/// Makes the factor of a tree. Every node is eliminated together with the rod above it, from the tips to the
/// root. Time is linear in their number (Baraff 1996, Linear-time dynamics using Lagrange multipliers).
std::unique_ptr<RodFactor> make_tree_factor(const RodEquations& equations);
/// Makes the factor of any graph, a sparse LDLᵀ factorisation whose order is found once.
std::unique_ptr<RodFactor> make_sparse_factor(const RodEquations& equations);

/// Holds the equations of an island and the numbers of one solution.
class RodSolver {
 public:
  RodSolver(const Scene& island, MassModel model);
  RodSolver(RodSolver&&) = delete;  // the factor refers to the equations

  const RodEquations& equations() const { return equations_; }

  Array<Vec3> directions;  ///< Directions of the rows, in m, which the caller sets.
  Eigen::VectorXd f, c;    ///< Right-hand sides, which the caller sets.

  /// Solves M x - Jᵀ lambda = f, J x = c to rounding.
  ///
  /// Where rows are redundant, their compliances make the matrix definite. Refinement takes their error out
  /// of everything that a rod can pull on (the proximal point method). Each round leaves the share compliance
  /// / (compliance + stiffness^-1) of it.
  const Eigen::VectorXd& solve();
  /// Returns the largest share of an equation's terms that solutions have missed it by since the last call.
  double take_largest_miss() { return std::exchange(largest_miss_, 0.0); }

 private:
  double residuals();

  RodEquations equations_;
  std::unique_ptr<RodFactor> factor_;
  double largest_miss_ = 0;
  Refinement refinement_;
  Eigen::VectorXd x_, lambda_, left_f_, left_c_, dx_, dlambda_;
};

}  // namespace plumb::detail
