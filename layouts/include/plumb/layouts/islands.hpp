#pragma once

#include <cstdint>
#include <span>

#include "plumb/layouts/graph.hpp"
#include "plumb/layouts/memory.hpp"

namespace plumb::layouts {

/// Independent parts of a graph, as compressed rows: island i owns entries [begin[i], begin[i + 1]).
struct Islands {
  Array<std::uint32_t> vertex_begin;  ///< Start of each island's vertices; count() + 1 entries.
  Array<std::uint32_t> vertex_list;   ///< Vertices, island after island.
  Array<std::uint32_t> edge_begin;    ///< Start of each island's edges; count() + 1 entries.
  Array<std::uint32_t> edge_list;     ///< Edges, island after island.

  /// Number of islands.
  std::uint32_t count() const {
    return vertex_begin.empty() ? 0 : static_cast<std::uint32_t>(vertex_begin.size() - 1);
  }
  /// The movable vertices, ascending, then the fixed ones that its edges touch, ascending, each once.
  std::span<const std::uint32_t> vertices(std::uint32_t island) const {
    return std::span(vertex_list)
        .subspan(vertex_begin[island], vertex_begin[island + 1] - vertex_begin[island]);
  }
  /// The edges of an island, ascending.
  std::span<const std::uint32_t> edges(std::uint32_t island) const {
    return std::span(edge_list).subspan(edge_begin[island], edge_begin[island + 1] - edge_begin[island]);
  }
};

/// Finds the islands: movable vertices connected through edges, without passing through fixed vertices.
///
/// Islands are ordered by their smallest movable vertex; a movable vertex without edges is an island of its
/// own. A fixed vertex is listed in every island whose edges touch it, and in none if nothing touches it. An
/// edge between two fixed vertices belongs to no island. Near linear time.
Islands find_islands(const Graph& graph);

/// One island as a graph of its own.
struct LocalGraph {
  Array<Edge> edges;            ///< Edges, by local vertices.
  Array<std::uint8_t> movable;  ///< One per vertex: 0 if it is fixed, else 1.

  /// The same as a view, valid while this object lives and is not changed.
  Graph view() const { return {static_cast<std::uint32_t>(movable.size()), edges, movable}; }

  /// Whether edges and movable flags are equal.
  friend bool operator==(const LocalGraph&, const LocalGraph&) = default;
};

/// The edges of one island, renumbered to positions in islands.vertices(island), in the order of
/// islands.edges(island). Costs O(n log n) in the size of the island, whatever the size of the graph.
LocalGraph local_graph(const Graph& graph, const Islands& islands, std::uint32_t island);

/// Groups islands with the same local graph: same number of vertices, movable flags and edges, direction
/// included. Every island is in exactly one group; groups are ascending inside and ordered by their first
/// island. Near linear time in the size of the graph.
Array<Array<std::uint32_t>> group_equal_islands(const Graph& graph, const Islands& islands);

}  // namespace plumb::layouts
