#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "plumb/layouts/islands.hpp"
#include "plumb/settings.hpp"

namespace plumb::detail {

/// Lists the islands of a scene that one method moves. Islands of equal graphs share a set, whatever bends
/// they have.
struct IslandSets {
  layouts::Graph graph;                                 ///< of the whole scene
  const layouts::Islands& islands;                      ///< of the whole scene
  std::vector<std::vector<std::uint32_t>> sets;         ///< island numbers
  std::span<const std::vector<std::uint32_t>> bends{};  ///< by island; there are none if the scene has none

  /// Returns the bends of an island.
  std::span<const std::uint32_t> bends_of(std::uint32_t island) const {
    if (bends.empty()) return {};
    return bends[island];
  }
};

}  // namespace plumb::detail
