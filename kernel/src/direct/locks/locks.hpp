#pragma once

#include <cstdint>
#include <span>
#include <utility>

#include "plumb/layouts/memory.hpp"
#include "plumb/vec3.hpp"

namespace plumb::detail {

struct LoopState;

/// Nodes are locked where rigid rods lie in a straight line between anchors that are as far apart as the line
/// is long, or between other locked nodes. No motion is left to them, and no finite pull holds them there, so
/// that equations for their rods have no solution. They move as their anchors do, like anchors themselves.
/// So do particles that are wound on the drums of reels.
struct Locks {
  static constexpr std::uint32_t none = 0xffffffff;

  bool any() const { return !anchors.empty(); }
  bool has(std::uint32_t vertex) const { return vertex < anchors.size() && anchors[vertex] != none; }

  Array<std::uint32_t> anchors;  ///< Every node has the vertex that it moves with; empty if none has.
  /// Lines end at these anchors, which must keep their distance.
  Array<std::pair<std::uint32_t, std::uint32_t>> ends;
  /// Where rods gave, nodes are put here (m), by 10⁻³ of a rod at most: none would come to lie straight by
  /// itself. It is empty once they are.
  Array<std::pair<std::uint32_t, Vec3>> places;
};

/// A line may have this much slack, as a share of its length, and rods may be off theirs by as much. It is
/// what rounding makes of places and lengths. A line with this slack sags by 2e-6 of its length.
inline constexpr double most_slack = 1e-11;
/// Where rods gave, those of a line that would be taut may be off their lengths by this share.
inline constexpr double most_given = 1e-3;
/// Says whether a line of rigid rods (m) is locked between what is so far apart (m).
inline bool is_taut(double length, double distance) {
  return distance >= (1 - most_slack) * length;
}

/// Finds the nodes that are locked at the present positions, or would be but for rods that gave. There are
/// none while a rod between them is to be of another length, so that rods give, and that is counted.
Locks find_locks(const LoopState& state);

/// Says whether all lines keep their shape while anchors move as they do.
bool locks_hold(const LoopState& state);

/// Says whether a rod is of a locked line, or between two of them.
bool lies_between_held(const LoopState& state, std::uint32_t rod);

/// Returns the velocity of a locked node, in m/s.
Vec3 locked_velocity(const LoopState& state, std::uint32_t node);

/// Sets the displacements of locked nodes in a time, as their anchors move.
void move_locked(const LoopState& state, double time, std::span<double> displacements);

template <class Archive>
void visit_members(Archive& archive, Locks& of) {
  auto& [anchors, ends, places] = of;
  archive(anchors, ends);
}

}  // namespace plumb::detail
