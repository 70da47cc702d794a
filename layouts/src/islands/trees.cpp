#include "plumb/layouts/trees.hpp"

#include <algorithm>

namespace plumb::layouts {
namespace {

bool is_tie(const Graph& graph, const Edge& edge) {
  return graph.movable[edge.a] == 0 || graph.movable[edge.b] == 0;
}

std::uint32_t find_root(const Graph& graph, const Incidence& incidence) {
  std::uint32_t most = 0;
  std::ptrdiff_t ties = 1;
  for (std::uint32_t v = 0; v < graph.vertices; ++v) {
    if (graph.movable[v] == 0) continue;
    const auto edges = incidence.edges(v);
    const auto own =
        std::count_if(edges.begin(), edges.end(), [&](auto e) { return is_tie(graph, graph.edges[e]); });
    if (own > ties) {
      ties = own;
      most = v;
    }
  }
  if (ties > 1) return most;
  for (const Edge& edge : graph.edges)
    if (is_tie(graph, edge)) return graph.movable[edge.a] != 0 ? edge.a : edge.b;
  for (std::uint32_t v = 0; v < graph.vertices; ++v)
    if (graph.movable[v] != 0 && incidence.degree(v) <= 1) return v;
  return 0;  // a tree without an end does not exist
}

}  // namespace

std::optional<Tree> find_tree(const Graph& graph) {
  const auto movable =
      std::count_if(graph.movable.begin(), graph.movable.end(), [](auto m) { return m != 0; });
  const auto ties =
      std::count_if(graph.edges.begin(), graph.edges.end(), [&](const Edge& e) { return is_tie(graph, e); });
  if (static_cast<std::ptrdiff_t>(graph.edges.size()) - ties != movable - 1) return std::nullopt;

  const Incidence incidence = edges_by_vertex(graph);
  Tree tree;
  struct Visit {
    std::uint32_t vertex, parent, edge;
  };
  Array<Visit> open{{find_root(graph, incidence), 0, 0}};
  while (!open.empty()) {
    const Visit visit = open.back();
    open.pop_back();
    const std::uint32_t node = tree.nodes();
    if (node == static_cast<std::uint32_t>(movable))
      return std::nullopt;  // a cycle, beside parts that are not
    tree.vertex.push_back(visit.vertex);
    tree.parent.push_back(visit.parent);
    tree.edge.push_back(visit.edge);
    tree.tie_begin.push_back(static_cast<std::uint32_t>(tree.ties.size()));
    const auto edges = incidence.edges(visit.vertex);
    for (const std::uint32_t e : edges)
      if (is_tie(graph, graph.edges[e])) tree.ties.push_back({other_end(graph.edges[e], visit.vertex), e});
    // Backwards, so that the edge with the smallest number is followed first.
    for (auto e = edges.rbegin(); e != edges.rend(); ++e)
      if (!is_tie(graph, graph.edges[*e]) && (node == 0 || *e != visit.edge))
        open.push_back({other_end(graph.edges[*e], visit.vertex), node, *e});
  }
  if (tree.nodes() != static_cast<std::uint32_t>(movable)) return std::nullopt;
  tree.tie_begin.push_back(static_cast<std::uint32_t>(tree.ties.size()));
  return tree;
}

}  // namespace plumb::layouts
