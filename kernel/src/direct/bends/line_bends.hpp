#pragma once

#include <array>
#include <cstdint>
#include <optional>

#include "direct/loops/loop_elements.hpp"
#include "plumb/layouts/memory.hpp"
#include "plumb/layouts/trees.hpp"
#include "simd/tree/tree_kernels.hpp"

namespace plumb::detail {

/// Says where the bends of a line are, which is a tree that never branches, and its twist.
///
/// Its places are numbered along it: its nodes from 0 on, the root's anchor -1 and its clamp -2, and beyond
/// the tip an anchor and a clamp. A bend has the slot of its last place, so that there are nodes + 2 slots.
struct LineBends {
  /// Ties that stand at the clamp and the anchor of the root, and at the anchor and the clamp of the tip.
  /// Clamps have no rods, and follow the ties of the tree.
  std::array<std::uint32_t, 4> ends{simd::no_slot, simd::no_slot, simd::no_slot, simd::no_slot};
  Array<std::uint32_t> clamps{};  ///< Vertices of the island that ties after those of the tree are at.
  Array<std::uint32_t> slots{};   ///< There is one per bend of the island.
  Array<std::uint8_t> turned{};   ///< They say of bends that they were given from the tip on.

  /// The joints of its twisted chain have the slots from the first of these to the one before the second, as
  /// bends there would.
  std::uint32_t twist_begin = 0, twist_end = 0;

  bool operator==(const LineBends&) const = default;
  bool is_twisted() const { return twist_end > 0; }
  bool any() const { return !slots.empty() || is_twisted(); }
  /// Returns the tie at a place that is not a node of `nodes`.
  std::uint32_t end(std::int64_t place, std::uint32_t nodes) const {
    return ends[static_cast<std::size_t>(place < 0 ? place + 2 : place - nodes + 2)];
  }
};

/// Finds the places of an island's bends and of its twist along its tree. Returns none if the tree branches,
/// or if there is something else than one bend each of three places in turn and one twist of places in turn.
std::optional<LineBends> find_line_bends(const layouts::Tree& tree, const LoopElements& elements);

}  // namespace plumb::detail
