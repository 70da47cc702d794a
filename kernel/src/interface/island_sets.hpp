#pragma once

#include <cstdint>

#include "plumb/layouts/islands.hpp"
#include "plumb/layouts/memory.hpp"
#include "plumb/settings.hpp"
#include "scene/bends/bent_islands.hpp"

namespace plumb::detail {

/// Lists the islands of a scene that one method moves. Islands of equal graphs share a set, whatever elements
/// they have.
struct IslandSets {
  layouts::Graph graph;              ///< of the whole scene
  const layouts::Islands& islands;   ///< of the whole scene
  Array<Array<std::uint32_t>> sets;  ///< island numbers
  IslandElements elements{};         ///< bends, tackles, twists and reels
};

}  // namespace plumb::detail
