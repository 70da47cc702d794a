#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "plumb/layouts/islands.hpp"
#include "plumb/settings.hpp"

namespace plumb::detail {

/// Lists the islands of a scene that one method moves. Islands of equal graphs share a set, whatever bends
/// and tackles they have.
struct IslandSets {
  layouts::Graph graph;                          ///< of the whole scene
  const layouts::Islands& islands;               ///< of the whole scene
  std::vector<std::vector<std::uint32_t>> sets;  ///< island numbers
  /// These are by island; there are none if the scene has none.
  std::span<const std::vector<std::uint32_t>> bends{}, tackles{};

  /// Returns the bends of an island.
  std::span<const std::uint32_t> bends_of(std::uint32_t island) const { return of(bends, island); }
  /// Returns the tackles of an island.
  std::span<const std::uint32_t> tackles_of(std::uint32_t island) const { return of(tackles, island); }

 private:
  static std::span<const std::uint32_t> of(std::span<const std::vector<std::uint32_t>> all,
                                           std::uint32_t island) {
    if (all.empty()) return {};
    return all[island];
  }
};

}  // namespace plumb::detail
