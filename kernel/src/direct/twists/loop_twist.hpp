#pragma once

#include <array>
#include <cstdint>

#include "plumb/layouts/memory.hpp"

namespace plumb::detail {

/// A twisted chain of an island has these vertices, one after the other. In a ring the last is the first.
struct LoopTwist {
  Array<std::uint32_t> vertices;

  bool is_ring() const { return vertices.front() == vertices.back(); }
  /// Counts the vertices where two of its rods meet.
  std::uint32_t joints() const { return static_cast<std::uint32_t>(vertices.size()) - (is_ring() ? 1 : 2); }
  /// Returns a joint: the vertex where two rods meet, between their other ends.
  std::array<std::uint32_t, 3> joint(std::uint32_t k) const {
    return {vertices[k], vertices[k + 1], vertices[k + 2 < vertices.size() ? k + 2 : 1]};
  }

  /// Newton's matrix has so many values of each joint. Every two of its vertices, in both orders, have a 3 x
  /// 3 tile. Every vertex has 3 numbers of what the torque pulls and 3 of what twists the chain.
  static constexpr std::uint32_t per_joint = 9 * 9 + 3 * 3 + 3 * 3;
  static constexpr std::uint32_t at_pulls = 9 * 9, at_row = at_pulls + 3 * 3;
  std::uint32_t values() const { return per_joint * joints() + 1; }  ///< The last is the torque's own.

  friend bool operator==(const LoopTwist&, const LoopTwist&) = default;
  friend auto operator<=>(const LoopTwist&, const LoopTwist&) = default;
};

}  // namespace plumb::detail
