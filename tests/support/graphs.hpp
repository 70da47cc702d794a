#pragma once

#include <algorithm>
#include <cstdint>
#include <numeric>
#include <random>
#include <set>
#include <utility>

#include "plumb/layouts/islands.hpp"
#include "plumb/layouts/memory.hpp"

/// Graphs to test layouts on, each made from its seed alone.
namespace plumb::test {

using Ids = Array<std::uint32_t>;
using Random = std::mt19937;

// std::uniform_int_distribution and std::shuffle differ between standard libraries; these do not.
inline std::uint32_t below(Random& random, std::uint32_t n) {
  return static_cast<std::uint32_t>(random() % n);
}

/// In [-1, 1).
inline double signed_unit(Random& random) {
  return static_cast<double>(random()) * 0x1p-31 - 1;
}

template <class List>
void shuffle(List& list, Random& random) {
  for (std::size_t i = list.size(); i > 1; --i)
    std::swap(list[i - 1], list[below(random, static_cast<std::uint32_t>(i))]);
}

inline Ids identity(std::size_t n) {
  Ids ids(n);
  std::iota(ids.begin(), ids.end(), 0u);
  return ids;
}

/// Up to `edges` different edges between random vertices, every tenth vertex fixed on average.
inline layouts::LocalGraph random_graph(Random& random, std::uint32_t vertices, std::uint32_t edges) {
  layouts::LocalGraph g;
  for (std::uint32_t v = 0; v < vertices; ++v) g.movable.push_back(below(random, 10) != 0 ? 1 : 0);
  std::set<std::pair<std::uint32_t, std::uint32_t>> seen;
  for (std::uint32_t i = 0; i < edges; ++i) {
    const std::uint32_t a = below(random, vertices);
    const std::uint32_t b = below(random, vertices);
    const bool has_movable_end = g.movable[a] != 0 || g.movable[b] != 0;
    if (a != b && has_movable_end && seen.insert(std::minmax(a, b)).second) g.edges.push_back({a, b});
  }
  return g;
}

/// A width × height lattice; height 1 is a chain.
inline layouts::LocalGraph lattice(std::uint32_t width, std::uint32_t height) {
  layouts::LocalGraph g;
  for (std::uint32_t v = 0; v < width * height; ++v) {
    if (v % width + 1 < width) g.edges.push_back({v, v + 1});
    if (v / width + 1 < height) g.edges.push_back({v, v + width});
  }
  g.movable.assign(width * height, 1);
  return g;
}

/// The same graph with vertices renumbered, edges in another order and some of them turned.
inline layouts::LocalGraph renumbered(const layouts::LocalGraph& g, Random& random) {
  Ids name = identity(g.movable.size());
  shuffle(name, random);
  layouts::LocalGraph result = g;
  for (std::size_t v = 0; v < name.size(); ++v) result.movable[name[v]] = g.movable[v];
  for (layouts::Edge& edge : result.edges) {
    edge = {name[edge.a], name[edge.b]};
    if (below(random, 2) == 0) std::swap(edge.a, edge.b);
  }
  shuffle(result.edges, random);
  return result;
}

}  // namespace plumb::test
