#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "plumb/layouts/graph.hpp"

namespace plumb::layouts {

/// An order of the vertices in which neighbours are close together: order[new position] = old vertex.
///
/// Reverse Cuthill–McKee (George and Liu's choice of start), component by component. A fixed vertex is placed
/// beside the first neighbour that reaches it and is not passed through: an anchor that holds half a scene
/// would otherwise pull all of it into one level. Keeps the given order unless the new one has a smaller
/// bandwidth between movable vertices or, of equals, over all edges, or then shorter edges in total.
/// Deterministic; O(E log E).
std::vector<std::uint32_t> bandwidth_reducing_order(const Graph& graph);

/// The largest distance between the positions of an edge's ends; 0 without edges. `order` is a permutation of
/// the vertices.
std::uint32_t bandwidth(const Graph& graph, std::span<const std::uint32_t> order);

}  // namespace plumb::layouts
