#pragma once

#include <cstdint>
#include <functional>
#include <span>

#include "direct/loops/loop_rod.hpp"
#include "plumb/layouts/memory.hpp"
#include "plumb/vec3.hpp"

namespace plumb::detail {

using Line = Array<std::uint32_t>;  ///< It lists rods, one after the other.

/// Puts all rods on paths that run on as straight as they can, such as the rows and columns of a net, the
/// longest first. `positions` of the vertices, the first `nodes` of which are movable.
Array<Line> find_lines(std::span<const LoopRod> rods, std::uint32_t nodes, std::span<const Vec3> positions);

/// Lines stand side by side, `lanes` of about the same length. A rod's slot says where: the first rods of all
/// of them come first, then the second. Slots that no rod has are padding.
struct RodLines {
  static constexpr std::uint32_t lanes = 8;
  static constexpr std::uint32_t none = 0xffffffff;

  RodLines(std::span<const Line> of, std::span<const LoopRod> rods, std::uint32_t nodes);

  /// Returns nodes in the order in which slots meet them, so that what is used together lies together.
  Array<std::uint32_t> node_order() const;

  std::uint32_t slots() const { return static_cast<std::uint32_t>(ends.size()); }

  std::uint32_t nodes;
  Array<LoopRod> ends;           ///< They are by slot; padding has 0 and 0.
  Array<std::uint32_t> numbers;  ///< They say by slot which rod it is; padding has none.
  /// They say by slot which node a rod shares with the one before it in its line. The sign is 1 if the same
  /// end of both is there, -1 if not, and 0 if none is before it.
  Array<std::uint32_t> joints;
  Array<double> turns;
  Array<std::uint32_t> packs;  ///< Lines side by side begin at these slots; the end of all follows.
  /// A rod meets a node with its end a (1) or b (-1).
  struct Meeting {
    std::uint32_t slot;
    double sign;
  };
  Array<std::uint32_t> first;  ///< The meetings of every node begin here; their end follows.
  Array<Meeting> meetings;     ///< Those of a node have ascending slots.
};

/// Solves A m = b, A = F W Fᵀ, with F the directions of rods and W the inverse masses of nodes. It takes
/// conjugate gradients (Hestenes, Stiefel 1952) without forming A. The preconditioner solves A's part along
/// lines exactly. In a net, rods of different lines are nearly at right angles and hardly feel each other.
///
/// Vectors are by slot. Sums are by lanes, the same whatever the instruction set.
class LineSolver {
 public:
  /// Takes the mass of every node, in any unit.
  LineSolver(const RodLines& lines, std::span<const double> mass);

  /// Takes the mass of every node anew. Nodes that `is_held` says do not move, whatever pulls on them.
  void set_masses(std::span<const double> mass, const std::function<bool(std::uint32_t)>& is_held);

  /// Returns the direction of every slot, three numbers each. That of padding is 0.
  std::span<double> directions() { return directions_; }
  /// Factorises lines. It is to be called when directions() have changed.
  void factorize();
  /// Returns W Fᵀ m of every node.
  void spread(std::span<const double> m, std::span<double> motion) const;
  /// Adds the solution to `m` and W Fᵀ of it to `motion`, until the residual's norm is at most `goal`. `b`
  /// becomes the residual. Returns whether `most` iterations were enough.
  bool solve(std::span<double> b, double goal, int most, std::span<double> m, std::span<double> motion);

  double inverse_mass(std::uint32_t node) const { return inverse_[node]; }
  /// Says whether neither end of the rod in a slot moves.
  bool is_held(std::uint32_t slot) const { return give_[slot] == 0; }

 private:
  double precondition(std::span<const double> residual);
  double multiply();

  const RodLines* lines_;
  Array<double> inverse_;  ///< They are by vertex of a rod; fixed ones have 0.
  Array<double> give_,
      share_;  ///< They are by slot: give of both ends, share of the joint with its turn.
  Array<double> directions_, motion_;
  Array<double> pivots_, links_;  ///< Lines' factors have inverse pivots, and links below the diagonal.
  Array<double> near_, along_, image_;
};

}  // namespace plumb::detail
