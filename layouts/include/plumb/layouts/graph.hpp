#pragma once

#include <cstdint>
#include <span>
#include <vector>

namespace plumb::layouts {

/// Joins vertices `a` and `b`; the direction is kept but means nothing here.
struct Edge {
  std::uint32_t a = 0;
  std::uint32_t b = 0;

  friend constexpr bool operator==(const Edge&, const Edge&) = default;
};

/// The end of `edge` that is not `vertex`.
constexpr std::uint32_t other_end(Edge edge, std::uint32_t vertex) {
  return edge.a == vertex ? edge.b : edge.a;
}

/// A graph to lay out. A view: it owns nothing.
///
/// `movable[v]` is 0 for fixed vertices; they connect nothing and conflict with nothing.
/// Expected, and not checked: every end is below `vertices`, no edge joins a vertex to itself, and
/// there are fewer than 2³¹ edges.
struct Graph {
  std::uint32_t vertices = 0;
  std::span<const Edge> edges;
  std::span<const std::uint8_t> movable;  ///< one per vertex
};

/// The edges at every vertex, fixed ones included, as compressed rows.
struct Incidence {
  std::vector<std::uint32_t> edge_begin;  ///< vertices + 1 entries
  std::vector<std::uint32_t> edge_list;   ///< two entries per edge

  /// Ids of the edges at `vertex`, ascending.
  std::span<const std::uint32_t> edges(std::uint32_t vertex) const {
    return std::span(edge_list).subspan(edge_begin[vertex], degree(vertex));
  }
  std::uint32_t degree(std::uint32_t vertex) const { return edge_begin[vertex + 1] - edge_begin[vertex]; }
};

/// Linear time.
inline Incidence edges_by_vertex(const Graph& graph) {
  Incidence result;
  result.edge_begin.assign(graph.vertices + std::size_t{1}, 0);
  result.edge_list.resize(2 * graph.edges.size());
  for (const Edge& edge : graph.edges) {
    ++result.edge_begin[edge.a + std::size_t{1}];
    ++result.edge_begin[edge.b + std::size_t{1}];
  }
  for (std::size_t v = 0; v < graph.vertices; ++v) result.edge_begin[v + 1] += result.edge_begin[v];
  std::vector<std::uint32_t> next(result.edge_begin.begin(), result.edge_begin.end() - 1);
  for (std::uint32_t e = 0; e < graph.edges.size(); ++e) {
    result.edge_list[next[graph.edges[e].a]++] = e;
    result.edge_list[next[graph.edges[e].b]++] = e;
  }
  return result;
}

}  // namespace plumb::layouts
