#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "plumb/layouts/islands.hpp"
#include "plumb/settings.hpp"

namespace plumb::detail {

/// Lists the islands of a scene that one method moves. Islands of equal graphs share a set, whatever bends
/// and twists they have.
struct IslandSets {
  layouts::Graph graph;                          ///< of the whole scene
  const layouts::Islands& islands;               ///< of the whole scene
  std::vector<std::vector<std::uint32_t>> sets;  ///< island numbers
  using Lists = std::span<const std::vector<std::uint32_t>>;
  Lists bends{};   ///< by island; there are none if the scene has none
  Lists twists{};  ///< as `bends`

  /// Returns the bends of an island.
  std::span<const std::uint32_t> bends_of(std::uint32_t island) const { return list(bends, island); }
  /// Returns the twists of an island.
  std::span<const std::uint32_t> twists_of(std::uint32_t island) const { return list(twists, island); }

 private:
  static std::span<const std::uint32_t> list(Lists lists, std::uint32_t island) {
    if (lists.empty()) return {};
    return lists[island];
  }
};

}  // namespace plumb::detail
