// Properties of islands, colourings, orders and shapes on random graphs. Every case is made from its seed
// alone.

#include "support/graphs.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cstdint>
#include <utility>
#include <vector>

#include "plumb/layouts/coloring.hpp"
#include "plumb/layouts/islands.hpp"
#include "plumb/layouts/ordering.hpp"
#include "plumb/layouts/shapes.hpp"

namespace plumb::layouts::PLUMB_TEST_FILE {
namespace {

using namespace test;

std::uint32_t max_degree(const LocalGraph& g) {
  const Incidence incidence = edges_by_vertex(g.view());
  std::uint32_t most = 0;
  for (std::uint32_t v = 0; v < g.movable.size(); ++v) {
    if (g.movable[v] != 0) most = std::max(most, incidence.degree(v));
  }
  return most;
}

/// Whether a grid's orders are what ShapeInfo promises, looking at nothing but the edges.
bool describes_lattice(const LocalGraph& g, const ShapeInfo& info) {
  const std::uint32_t width = info.width;
  const std::uint32_t height = info.height;
  Ids vertices = info.vertex_order;
  std::sort(vertices.begin(), vertices.end());
  Ids edges = info.edge_order;
  std::sort(edges.begin(), edges.end());
  if (width < 2 || height < 2 || std::size_t{width} * height != vertices.size()) return false;
  if (vertices != identity(g.movable.size()) || edges != identity(g.edges.size())) return false;

  std::size_t k = 0;
  const auto next_joins = [&](std::uint32_t from, std::uint32_t to) {
    const Edge expected{info.vertex_order[from], info.vertex_order[to]};
    const Edge edge = k < info.edge_order.size() ? g.edges[info.edge_order[k++]] : Edge{};
    return edge == expected || edge == Edge{expected.b, expected.a};
  };
  for (std::uint32_t v = 0; v < width * height; ++v) {
    if (v % width + 1 < width && !next_joins(v, v + 1)) return false;
  }
  for (std::uint32_t v = 0; v + width < width * height; ++v) {
    if (!next_joins(v, v + width)) return false;
  }
  return k == g.edges.size();
}

class Graphs : public testing::TestWithParam<unsigned> {
 protected:
  Random random{GetParam()};
};

TEST_P(Graphs, IslandsPartitionMovableVerticesAndEdges) {
  const std::uint32_t n = 1 + below(random, 300);
  const LocalGraph g = random_graph(random, n, below(random, n + 1));
  const Islands islands = find_islands(g.view());
  Ids island_of(n, islands.count());
  std::uint32_t edges = 0;
  std::uint32_t smallest_before = 0;
  for (std::uint32_t i = 0; i < islands.count(); ++i) {
    const auto vertices = islands.vertices(i);
    ASSERT_FALSE(vertices.empty());
    EXPECT_TRUE(i == 0 || vertices.front() > smallest_before);
    smallest_before = vertices.front();
    for (const std::uint32_t v : vertices) {
      if (g.movable[v] == 0) continue;
      EXPECT_EQ(island_of[v], islands.count()) << "vertex " << v << " is in two islands";
      island_of[v] = i;
    }
    edges += static_cast<std::uint32_t>(islands.edges(i).size());
  }
  for (std::uint32_t v = 0; v < n; ++v) EXPECT_EQ(island_of[v] < islands.count(), g.movable[v] != 0);
  EXPECT_EQ(edges, g.edges.size());
  for (std::uint32_t i = 0; i < islands.count(); ++i) {
    const auto vertices = islands.vertices(i);
    for (const std::uint32_t e : islands.edges(i)) {
      for (const std::uint32_t v : {g.edges[e].a, g.edges[e].b}) {
        EXPECT_TRUE(g.movable[v] == 0 || island_of[v] == i);
        EXPECT_EQ(std::count(vertices.begin(), vertices.end(), v), 1);
      }
    }
  }
}

TEST_P(Graphs, IslandsAreConnectedInside) {
  const std::uint32_t n = 1 + below(random, 300);
  const LocalGraph g = random_graph(random, n, below(random, 2 * n));
  const Islands islands = find_islands(g.view());
  for (std::uint32_t i = 0; i < islands.count(); ++i) {
    // Within its own local graph an island is one island, with all vertices and edges.
    const LocalGraph local = local_graph(g.view(), islands, i);
    const Islands again = find_islands(local.view());
    ASSERT_EQ(again.count(), 1u);
    EXPECT_EQ(again.vertices(0).size(), local.movable.size());
    EXPECT_EQ(again.edges(0).size(), local.edges.size());
    EXPECT_EQ(local_graph(local.view(), again, 0), local);
    for (std::size_t k = 0; k < local.edges.size(); ++k) {
      const Edge edge = g.edges[islands.edges(i)[k]];
      EXPECT_EQ((Edge{islands.vertices(i)[local.edges[k].a], islands.vertices(i)[local.edges[k].b]}), edge);
    }
  }
}

TEST_P(Graphs, GroupsHoldEqualIslandsAndOnlyThose) {
  const std::uint32_t n = 100 + below(random, 300);
  const LocalGraph g = random_graph(random, n, n / 3);  // sparse: many small islands, many alike
  const Islands islands = find_islands(g.view());
  const auto groups = group_equal_islands(g.view(), islands);
  std::vector<LocalGraph> kinds;
  std::size_t grouped = 0;
  for (const Ids& group : groups) {
    kinds.push_back(local_graph(g.view(), islands, group.front()));
    for (const std::uint32_t island : group) EXPECT_EQ(local_graph(g.view(), islands, island), kinds.back());
    EXPECT_TRUE(std::is_sorted(group.begin(), group.end()));
    grouped += group.size();
  }
  EXPECT_EQ(grouped, islands.count());
  EXPECT_LT(groups.size(), islands.count());
  for (std::size_t i = 0; i < kinds.size(); ++i) {
    for (std::size_t k = 0; k < i; ++k) EXPECT_FALSE(kinds[i] == kinds[k]) << "groups " << k << " and " << i;
  }
}

TEST_P(Graphs, ColoringsAreValidAndSmall) {
  const std::uint32_t n = 2 + below(random, 300);
  const LocalGraph g = random_graph(random, n, below(random, 6 * n));
  const Coloring coloring = color_edges(g.view());
  EXPECT_TRUE(is_valid(g.view(), coloring));
  EXPECT_GE(coloring.colors, max_degree(g));
  EXPECT_LT(coloring.colors, std::max(1u, 2 * max_degree(g)));  // at most 2Δ − 1, or none
  EXPECT_EQ(color_edges(g.view()).color_of_edge, coloring.color_of_edge);
}

TEST_P(Graphs, ColoringsOfNetsAreBalanced) {
  const LocalGraph g = renumbered(lattice(10 + below(random, 30), 10 + below(random, 30)), random);
  const Coloring coloring = color_edges(g.view());
  ASSERT_TRUE(is_valid(g.view(), coloring));
  Ids edges_of(coloring.colors, 0);
  for (const std::uint32_t color : coloring.color_of_edge) ++edges_of[color];
  // The last colour opened may stay small, so only the largest is bounded: 1.17 means was the most seen over
  // these seeds; always taking the first allowed colour gives more than 2.
  const double mean = static_cast<double>(g.edges.size()) / coloring.colors;
  EXPECT_LE(*std::max_element(edges_of.begin(), edges_of.end()), 1.25 * mean);
}

TEST_P(Graphs, OrdersArePermutationsNoWiderThanGiven) {
  const std::uint32_t n = 1 + below(random, 300);
  const LocalGraph g = random_graph(random, n, below(random, 3 * n));
  Ids order = bandwidth_reducing_order(g.view());
  EXPECT_EQ(bandwidth_reducing_order(g.view()), order);
  LocalGraph between_movable{{}, g.movable};
  for (const Edge& edge : g.edges) {
    if (g.movable[edge.a] != 0 && g.movable[edge.b] != 0) between_movable.edges.push_back(edge);
  }
  EXPECT_LE(bandwidth(between_movable.view(), order), bandwidth(between_movable.view(), identity(n)));
  std::sort(order.begin(), order.end());
  EXPECT_EQ(order, identity(n));
}

TEST_P(Graphs, OrdersUntangleChains) {
  LocalGraph chain = lattice(3 + below(random, 300), 1);
  if (below(random, 2) == 0) chain.movable.front() = 0;
  if (below(random, 2) == 0) chain.movable.back() = 0;
  const LocalGraph g = renumbered(chain, random);
  EXPECT_EQ(bandwidth(g.view(), bandwidth_reducing_order(g.view())), 1u);
}

TEST_P(Graphs, OrdersUntangleNets) {
  const std::uint32_t width = 5 + below(random, 20);
  const std::uint32_t height = 5 + below(random, 20);
  LocalGraph net = lattice(width, height);
  if (below(random, 2) == 0) net.movable[0] = net.movable[width - 1] = 0;
  const LocalGraph g = renumbered(net, random);
  // Row by row along the shorter side gives min(width, height), and no order is better; levels from a corner
  // give as much, plus one or two beside fixed corners, which are not passed through.
  EXPECT_LE(bandwidth(g.view(), bandwidth_reducing_order(g.view())), std::min(width, height) + 2);
}

TEST_P(Graphs, ChainsAreFoundUnderAnyNumbering) {
  LocalGraph chain = lattice(2 + below(random, 100), 1);
  if (below(random, 2) == 0) chain.movable.front() = 0;
  if (chain.movable.size() > 2 && below(random, 2) == 0) chain.movable.back() = 0;
  const LocalGraph g = renumbered(chain, random);
  const ShapeInfo info = detect_shape(g.view());
  ASSERT_EQ(info.shape, Shape::chain);
  ASSERT_EQ(info.vertex_order.size(), g.movable.size());
  ASSERT_EQ(info.edge_order.size(), g.edges.size());
  const std::uint32_t first = info.vertex_order.front();
  const std::uint32_t last = info.vertex_order.back();
  EXPECT_LE(std::pair(g.movable[first], first), std::pair(g.movable[last], last));
  for (std::size_t k = 0; k < g.edges.size(); ++k) {
    const Edge edge = g.edges[info.edge_order[k]];
    EXPECT_EQ(std::minmax(edge.a, edge.b), std::minmax(info.vertex_order[k], info.vertex_order[k + 1]));
  }
}

TEST_P(Graphs, GridsAreFoundUnderAnyNumbering) {
  const std::uint32_t width = 3 + below(random, 12);
  const std::uint32_t height = 2 + below(random, 12);
  LocalGraph net = lattice(width, height);
  if (below(random, 2) == 0) net.movable[0] = net.movable[width - 1] = 0;
  const LocalGraph g = renumbered(net, random);
  const ShapeInfo info = detect_shape(g.view());
  ASSERT_EQ(info.shape, Shape::grid);
  EXPECT_EQ(std::minmax(info.width, info.height), std::minmax(width, height));
  EXPECT_TRUE(describes_lattice(g, info));
}

TEST_P(Graphs, NearGridsAreNotGrids) {
  const std::uint32_t width = 3 + below(random, 8);
  const std::uint32_t height = 3 + below(random, 8);
  const LocalGraph net = lattice(width, height);

  LocalGraph missing = net;
  missing.edges.erase(missing.edges.begin() + below(random, static_cast<std::uint32_t>(net.edges.size())));
  EXPECT_EQ(detect_shape(renumbered(missing, random).view()).shape, Shape::graph);

  // One edge more, and one edge moved: as many as a lattice has.
  const std::uint32_t vertices = width * height;
  Edge extra;
  do {
    extra = {below(random, vertices), below(random, vertices)};
  } while (extra.a == extra.b || std::count(net.edges.begin(), net.edges.end(), extra) != 0 ||
           std::count(net.edges.begin(), net.edges.end(), Edge{extra.b, extra.a}) != 0);
  LocalGraph added = net;
  added.edges.push_back(extra);
  EXPECT_EQ(detect_shape(renumbered(added, random).view()).shape, Shape::graph);
  LocalGraph moved = missing;
  moved.edges.push_back(extra);
  EXPECT_EQ(detect_shape(renumbered(moved, random).view()).shape, Shape::graph);
}

TEST_P(Graphs, EveryGridClaimedIsOne) {
  // Edges that swap ends keep all degrees and both counts. Some results are lattices again, most are not.
  constexpr int tries = 300;
  int claimed = 0;
  for (int i = 0; i < tries; ++i) {
    LocalGraph g = lattice(2 + below(random, 4), 2 + below(random, 4));
    const auto edges = static_cast<std::uint32_t>(g.edges.size());
    for (std::uint32_t swaps = 1 + below(random, 3); swaps > 0; --swaps) {
      Edge& first = g.edges[below(random, edges)];
      Edge& second = g.edges[below(random, edges)];
      if (below(random, 2) == 0) std::swap(second.a, second.b);
      if (first.a != second.b && second.a != first.b) std::swap(first.b, second.b);
    }
    const ShapeInfo info = detect_shape(g.view());
    if (info.shape != Shape::grid) continue;
    ++claimed;
    EXPECT_TRUE(describes_lattice(g, info));
  }
  EXPECT_GT(claimed, 0);
  EXPECT_LT(claimed, tries);
}

INSTANTIATE_TEST_SUITE_P(Seeds, Graphs, testing::Range(0u, 50u));

}  // namespace
}  // namespace plumb::layouts::PLUMB_TEST_FILE
