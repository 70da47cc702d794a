#pragma once

#include <cstdint>
#include <span>

#include "plumb/layouts/graph.hpp"
#include "plumb/layouts/memory.hpp"

namespace plumb::layouts {

/// An order of the vertices in which neighbours are close together: order[new position] = old vertex.
///
/// It is reverse Cuthill–McKee with George and Liu's choice of start, component by component. A fixed vertex
/// is placed beside the first neighbour that reaches it and is not passed through. An anchor that holds half
/// a scene would otherwise pull all of it into one level.
///
/// The given order is kept unless the new one has a smaller bandwidth between movable vertices. Of equals the
/// bandwidth over all edges decides, then the total length of edges. The result is deterministic and costs
/// O(E log E).
Array<std::uint32_t> bandwidth_reducing_order(const Graph& graph);

/// The largest distance between the positions of an edge's ends; 0 without edges. `order` is a permutation of
/// the vertices.
std::uint32_t bandwidth(const Graph& graph, std::span<const std::uint32_t> order);

}  // namespace plumb::layouts
