#pragma once

#include <cstdint>
#include <span>

#include "plumb/layouts/memory.hpp"

namespace plumb::layouts {

/// Joins vertices `a` and `b`. The direction is kept but means nothing here.
struct Edge {
  std::uint32_t a = 0;  ///< One end.
  std::uint32_t b = 0;  ///< The other end.

  /// Whether both ends are equal, in their order.
  friend constexpr bool operator==(const Edge&, const Edge&) = default;
};

/// The end of `edge` that is not `vertex`.
constexpr std::uint32_t other_end(Edge edge, std::uint32_t vertex) {
  return edge.a == vertex ? edge.b : edge.a;
}

/// A graph to lay out. It is a view and owns nothing.
///
/// Fixed vertices connect nothing and conflict with nothing. Callers see to it that every end is below
/// `vertices`, that no edge joins a vertex to itself, and that there are fewer than 2³¹ edges. None of this
/// is checked.
struct Graph {
  std::uint32_t vertices = 0;             ///< Number of vertices.
  std::span<const Edge> edges;            ///< Edges between them.
  std::span<const std::uint8_t> movable;  ///< One per vertex: 0 if it is fixed, else 1.
};

/// The edges at every vertex, fixed ones included, as compressed rows.
struct Incidence {
  Array<std::uint32_t> edge_begin;  ///< Start of each vertex's row; vertices + 1 entries.
  Array<std::uint32_t> edge_list;   ///< Ids of edges, two entries per edge.

  /// Ids of the edges at `vertex`, ascending.
  std::span<const std::uint32_t> edges(std::uint32_t vertex) const {
    return std::span(edge_list).subspan(edge_begin[vertex], degree(vertex));
  }
  /// Number of edges at `vertex`.
  std::uint32_t degree(std::uint32_t vertex) const { return edge_begin[vertex + 1] - edge_begin[vertex]; }
};

/// Finds the edges at every vertex, in linear time.
inline Incidence edges_by_vertex(const Graph& graph) {
  Incidence result;
  result.edge_begin.assign(graph.vertices + std::size_t{1}, 0);
  result.edge_list.resize(2 * graph.edges.size());
  for (const Edge& edge : graph.edges) {
    ++result.edge_begin[edge.a + std::size_t{1}];
    ++result.edge_begin[edge.b + std::size_t{1}];
  }
  for (std::size_t v = 0; v < graph.vertices; ++v) result.edge_begin[v + 1] += result.edge_begin[v];
  Array<std::uint32_t> next(result.edge_begin.begin(), result.edge_begin.end() - 1);
  for (std::uint32_t e = 0; e < graph.edges.size(); ++e) {
    result.edge_list[next[graph.edges[e].a]++] = e;
    result.edge_list[next[graph.edges[e].b]++] = e;
  }
  return result;
}

}  // namespace plumb::layouts
