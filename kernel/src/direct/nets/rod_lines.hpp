#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "direct/loops/loop_rod.hpp"
#include "plumb/vec3.hpp"

namespace plumb::detail {

using Line = std::vector<std::uint32_t>;  ///< rods, one after the other

/// All rods on paths that run on as straight as they can, such as the rows and columns of a net; the longest
/// first. `positions` of the vertices, the first `nodes` of which are movable.
std::vector<Line> find_lines(std::span<const LoopRod> rods, std::uint32_t nodes,
                             std::span<const Vec3> positions);

/// Lines side by side, `lanes` of about the same length; a rod's slot says where: the first rods of all of
/// them, then the second. Slots that no rod has are padding.
struct RodLines {
  static constexpr std::uint32_t lanes = 8;
  static constexpr std::uint32_t none = 0xffffffff;

  RodLines(std::span<const Line> of, std::span<const LoopRod> rods, std::uint32_t nodes);

  /// Nodes in the order in which slots meet them, so that what is used together lies together.
  std::vector<std::uint32_t> node_order() const;

  std::uint32_t slots() const { return static_cast<std::uint32_t>(ends.size()); }

  std::uint32_t nodes;
  std::vector<LoopRod> ends;           ///< by slot; of padding 0 and 0
  std::vector<std::uint32_t> numbers;  ///< by slot: which rod; none if padding
  /// By slot: the node that a rod shares with the one before it in its line, and 1 if the same end of both is
  /// there, -1 if not; 0 if none is before it.
  std::vector<std::uint32_t> joints;
  std::vector<double> turns;
  std::vector<std::uint32_t> packs;  ///< the slots where lines side by side begin, and the end of all
  /// A rod at a node: 1 for its end a, -1 for its end b.
  struct Meeting {
    std::uint32_t slot;
    double sign;
  };
  std::vector<std::uint32_t> first;  ///< meeting of every node, and their end
  std::vector<Meeting> meetings;     ///< of a node, slots ascending
};

/// Solves A m = b, A = F W Fᵀ with F the directions of rods and W the inverse masses of nodes, by conjugate
/// gradients (Hestenes, Stiefel 1952) without forming A. The preconditioner is A's part along lines, solved
/// exactly: in a net, rods of different lines are nearly at right angles and hardly feel each other.
///
/// Vectors are by slot. Sums are by lanes, the same whatever the instruction set.
class LineSolver {
 public:
  /// `mass` of every node, in any unit.
  LineSolver(const RodLines& lines, std::span<const double> mass);

  /// The direction of every slot, three numbers each; of padding 0.
  std::span<double> directions() { return directions_; }
  /// To be called when directions() have changed.
  void factorize();
  /// W Fᵀ m of every node.
  void spread(std::span<const double> m, std::span<double> motion) const;
  /// Adds the solution to `m` and W Fᵀ of it to `motion`. Until the residual's norm is at most `goal`; `b`
  /// becomes the residual. Returns whether `most` iterations were enough.
  bool solve(std::span<double> b, double goal, int most, std::span<double> m, std::span<double> motion);

  double inverse_mass(std::uint32_t node) const { return inverse_[node]; }

 private:
  double precondition(std::span<const double> residual);
  double multiply();

  const RodLines* lines_;
  std::vector<double> inverse_;       ///< by vertex of a rod; 0 of fixed ones
  std::vector<double> give_, share_;  ///< by slot: of both ends; of the joint, with its turn
  std::vector<double> directions_, motion_;
  std::vector<double> pivots_, links_;  ///< of the lines' factors: inverse pivots, and below the diagonal
  std::vector<double> near_, along_, image_;
};

}  // namespace plumb::detail
