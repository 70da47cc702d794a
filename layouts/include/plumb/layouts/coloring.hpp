#pragma once

#include <cstdint>

#include "plumb/layouts/graph.hpp"
#include "plumb/layouts/memory.hpp"

namespace plumb::layouts {

/// A colour for every edge. Edges of one colour share no movable vertex and can be solved at once.
struct Coloring {
  Array<std::uint32_t> color_of_edge;  ///< Colour of every edge, numbered from 0.
  std::uint32_t colors = 0;            ///< Number of colours.
};

/// Colours edges so that two edges that share a movable vertex get different colours.
///
/// It goes through edges in their order and takes the least used of the allowed colours, the lowest of
/// equals. It opens a new colour only when none is allowed. Colours come out of similar size, though the last
/// may stay small. With Δ the most edges at a movable vertex, there are fewer than 2Δ colours, and the cost
/// is at most O(E Δ). The result is deterministic.
Coloring color_edges(const Graph& graph);

/// Whether every edge has one of the colours and no two edges of a colour share a movable vertex.
bool is_valid(const Graph& graph, const Coloring& coloring);

}  // namespace plumb::layouts
