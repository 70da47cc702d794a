#pragma once

#include <cstdint>
#include <vector>

#include "plumb/layouts/graph.hpp"

namespace plumb::layouts {

/// Colours are numbered from 0; edges of one colour can be solved at once.
struct Coloring {
  std::vector<std::uint32_t> color_of_edge;
  std::uint32_t colors = 0;
};

/// Colours edges so that two edges that share a movable vertex get different colours.
///
/// Greedy, in the order of the edges: takes the least used of the allowed colours (the lowest of equals) and
/// opens a new one only when none is allowed. Colours come out of similar size, though the last opened may
/// stay small, and there are fewer than 2Δ of them, Δ being the most edges at a movable vertex.
/// Deterministic. Costs O(E Δ) at worst.
Coloring color_edges(const Graph& graph);

/// Whether every edge has one of the colours and no two edges of a colour share a movable vertex.
bool is_valid(const Graph& graph, const Coloring& coloring);

}  // namespace plumb::layouts
