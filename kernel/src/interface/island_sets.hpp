#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "plumb/layouts/islands.hpp"
#include "plumb/settings.hpp"

namespace plumb::detail {

/// Lists the islands of a scene that one method moves. Islands of equal graphs share a set.
struct IslandSets {
  layouts::Graph graph;                          ///< of the whole scene
  const layouts::Islands& islands;               ///< of the whole scene
  std::vector<std::vector<std::uint32_t>> sets;  ///< island numbers
};

}  // namespace plumb::detail
