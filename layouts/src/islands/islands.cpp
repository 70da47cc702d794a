#include "plumb/layouts/islands.hpp"

#include <algorithm>
#include <numeric>
#include <unordered_map>
#include <utility>

#include "../unset.hpp"

namespace plumb::layouts {
namespace {

/// Disjoint sets whose root is their smallest member.
class DisjointSets {
 public:
  explicit DisjointSets(std::uint32_t n) : parent_(n) { std::iota(parent_.begin(), parent_.end(), 0u); }

  std::uint32_t find(std::uint32_t v) {
    while (parent_[v] != v) v = parent_[v] = parent_[parent_[v]];
    return v;
  }

  void unite(std::uint32_t a, std::uint32_t b) {
    a = find(a);
    b = find(b);
    parent_[std::max(a, b)] = std::min(a, b);
  }

 private:
  Array<std::uint32_t> parent_;
};

struct Rows {
  Array<std::uint32_t> begin;
  Array<std::uint32_t> list;
};

/// Items 0, 1, ... sorted into `count` rows by `row_of`, ascending within a row; items without a row are left
/// out.
Rows sort_into_rows(std::span<const std::uint32_t> row_of, std::uint32_t count) {
  Rows rows;
  rows.begin.assign(count + std::size_t{1}, 0);
  for (const std::uint32_t row : row_of) {
    if (row != unset) ++rows.begin[row + std::size_t{1}];
  }
  for (std::size_t i = 0; i < count; ++i) rows.begin[i + 1] += rows.begin[i];
  rows.list.resize(rows.begin.back());
  Array<std::uint32_t> next(rows.begin.begin(), rows.begin.end() - 1);
  for (std::uint32_t item = 0; item < row_of.size(); ++item) {
    if (row_of[item] != unset) rows.list[next[row_of[item]]++] = item;
  }
  return rows;
}

/// Does what local_graph() does into an existing object, so that a pass over many islands does not allocate
/// for each.
void fill_local_graph(const Graph& graph, const Islands& islands, std::uint32_t island, LocalGraph& local) {
  const auto vertices = islands.vertices(island);
  const auto first_fixed = std::partition_point(vertices.begin(), vertices.end(),
                                                [&](std::uint32_t v) { return graph.movable[v] != 0; });
  const auto position = [&](std::uint32_t v) {
    const auto at = graph.movable[v] != 0 ? std::lower_bound(vertices.begin(), first_fixed, v)
                                          : std::lower_bound(first_fixed, vertices.end(), v);
    return static_cast<std::uint32_t>(at - vertices.begin());
  };

  local.movable.assign(vertices.size(), 0);
  std::fill_n(local.movable.begin(), first_fixed - vertices.begin(), std::uint8_t{1});
  local.edges.clear();
  local.edges.reserve(islands.edges(island).size());
  for (const std::uint32_t e : islands.edges(island)) {
    local.edges.push_back({position(graph.edges[e].a), position(graph.edges[e].b)});
  }
}

/// Mixes every bit of `value` into `hash` (constants of the splitmix64 generator).
std::uint64_t mix(std::uint64_t hash, std::uint64_t value) {
  hash = (hash ^ value) + 0x9e3779b97f4a7c15u;
  hash = (hash ^ (hash >> 30)) * 0xbf58476d1ce4e5b9u;
  hash = (hash ^ (hash >> 27)) * 0x94d049bb133111ebu;
  return hash ^ (hash >> 31);
}

std::uint64_t hash_of(const LocalGraph& local) {
  // Movable vertices come first, so their number stands for all the flags.
  std::uint64_t hash = mix(local.movable.size(),
                           std::accumulate(local.movable.begin(), local.movable.end(), std::uint64_t{0}));
  for (const Edge& edge : local.edges) hash = mix(hash, std::uint64_t{edge.a} << 32 | edge.b);
  return hash;
}

}  // namespace

Islands find_islands(const Graph& graph) {
  DisjointSets sets(graph.vertices);
  for (const Edge& edge : graph.edges) {
    if (graph.movable[edge.a] != 0 && graph.movable[edge.b] != 0) sets.unite(edge.a, edge.b);
  }

  // A root is the smallest vertex of its island, so it is met first and islands are numbered in the order
  // asked.
  Array<std::uint32_t> island_of(graph.vertices, unset);
  std::uint32_t count = 0;
  for (std::uint32_t v = 0; v < graph.vertices; ++v) {
    if (graph.movable[v] == 0) continue;
    const std::uint32_t root = sets.find(v);
    island_of[v] = root == v ? count++ : island_of[root];
  }

  Array<std::uint32_t> island_of_edge(graph.edges.size());
  for (std::size_t e = 0; e < graph.edges.size(); ++e) {
    const Edge& edge = graph.edges[e];
    island_of_edge[e] = island_of[graph.movable[edge.a] != 0 ? edge.a : edge.b];
  }
  const Rows movable = sort_into_rows(island_of, count);
  Rows edges = sort_into_rows(island_of_edge, count);

  Islands islands;
  islands.edge_begin = std::move(edges.begin);
  islands.edge_list = std::move(edges.list);
  islands.vertex_begin.reserve(count + std::size_t{1});
  islands.vertex_begin.push_back(0);
  islands.vertex_list.reserve(graph.vertices);
  Array<std::uint32_t> last_listed_in(graph.vertices, unset);
  for (std::uint32_t island = 0; island < count; ++island) {
    islands.vertex_list.insert(islands.vertex_list.end(), movable.list.begin() + movable.begin[island],
                               movable.list.begin() + movable.begin[island + 1]);
    const auto first_fixed = static_cast<std::ptrdiff_t>(islands.vertex_list.size());
    for (const std::uint32_t e : islands.edges(island)) {
      for (const std::uint32_t v : {graph.edges[e].a, graph.edges[e].b}) {
        if (graph.movable[v] != 0 || last_listed_in[v] == island) continue;
        last_listed_in[v] = island;
        islands.vertex_list.push_back(v);
      }
    }
    std::sort(islands.vertex_list.begin() + first_fixed, islands.vertex_list.end());
    islands.vertex_begin.push_back(static_cast<std::uint32_t>(islands.vertex_list.size()));
  }
  return islands;
}

LocalGraph local_graph(const Graph& graph, const Islands& islands, std::uint32_t island) {
  LocalGraph local;
  fill_local_graph(graph, islands, island, local);
  return local;
}

Array<Array<std::uint32_t>> group_equal_islands(const Graph& graph, const Islands& islands) {
  Array<Array<std::uint32_t>> groups;
  Array<LocalGraph> graph_of_group;
  std::unordered_multimap<std::uint64_t, std::size_t> groups_by_hash;
  LocalGraph local;
  for (std::uint32_t island = 0; island < islands.count(); ++island) {
    fill_local_graph(graph, islands, island, local);
    const std::uint64_t hash = hash_of(local);
    const auto [first, last] = groups_by_hash.equal_range(hash);
    const auto same =
        std::find_if(first, last, [&](const auto& entry) { return graph_of_group[entry.second] == local; });
    if (same != last) {
      groups[same->second].push_back(island);
      continue;
    }
    groups_by_hash.emplace(hash, groups.size());
    groups.push_back({island});
    graph_of_group.push_back(std::exchange(local, {}));
  }
  return groups;
}

}  // namespace plumb::layouts
