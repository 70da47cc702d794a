// What every numbering of a tree must be, on random trees and on graphs that are none.

#include "plumb/layouts/trees.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cstdint>
#include <vector>

#include "plumb/layouts/islands.hpp"
#include "support/graphs.hpp"
#include "support/random_trees.hpp"
#include "support/sanitizers.hpp"

namespace plumb::layouts::PLUMB_TEST_FILE {
namespace {

using test::Ids;
using test::Random;

LocalGraph graph_of(const Scene& scene) {
  LocalGraph g;
  for (const Rod& rod : scene.rods) g.edges.push_back({rod.a, rod.b});
  for (const Particle& particle : scene.particles) g.movable.push_back(!particle.fixed);
  return g;
}

bool joins(const Edge& edge, std::uint32_t a, std::uint32_t b) {
  return (edge.a == a && edge.b == b) || (edge.a == b && edge.b == a);
}

void expect_numbers(const Tree& tree, const LocalGraph& g) {
  const auto movable = static_cast<std::uint32_t>(std::count(g.movable.begin(), g.movable.end(), 1));
  ASSERT_EQ(tree.nodes(), movable);
  Ids seen_vertices = tree.vertex, seen_edges;
  std::sort(seen_vertices.begin(), seen_vertices.end());
  EXPECT_EQ(std::adjacent_find(seen_vertices.begin(), seen_vertices.end()), seen_vertices.end());
  for (const std::uint32_t v : tree.vertex) EXPECT_EQ(g.movable[v], 1);

  EXPECT_EQ(tree.parent[0], 0u);
  Ids path{0};  // from the root to the last node: depth first, parents are on it
  for (std::uint32_t i = 1; i < tree.nodes(); ++i) {
    ASSERT_LT(tree.parent[i], i) << "parents come first";
    EXPECT_TRUE(joins(g.edges[tree.edge[i]], tree.vertex[i], tree.vertex[tree.parent[i]]));
    while (!path.empty() && path.back() != tree.parent[i]) path.pop_back();
    ASSERT_FALSE(path.empty()) << "node " << i << " is not depth first";
    path.push_back(i);
    seen_edges.push_back(tree.edge[i]);
  }
  ASSERT_EQ(tree.tie_begin.size(), tree.nodes() + std::size_t{1});
  EXPECT_EQ(tree.tie_begin.front(), 0u);
  EXPECT_EQ(tree.tie_begin.back(), tree.ties.size());
  for (std::uint32_t i = 0; i < tree.nodes(); ++i)
    for (std::uint32_t k = tree.tie_begin[i]; k < tree.tie_begin[i + 1]; ++k) {
      EXPECT_EQ(g.movable[tree.ties[k].vertex], 0);
      EXPECT_TRUE(joins(g.edges[tree.ties[k].edge], tree.vertex[i], tree.ties[k].vertex));
      if (k > tree.tie_begin[i]) {
        EXPECT_LT(tree.ties[k - 1].edge, tree.ties[k].edge);
      }
      seen_edges.push_back(tree.ties[k].edge);
    }
  std::sort(seen_edges.begin(), seen_edges.end());
  EXPECT_EQ(seen_edges, test::identity(g.edges.size())) << "every edge once";
}

/// The root as documented.
void expect_root(const Tree& tree, const LocalGraph& g) {
  std::vector<int> ties(g.movable.size(), 0);
  for (const Edge& edge : g.edges) {
    if (g.movable[edge.a] == 0) ++ties[edge.b];
    if (g.movable[edge.b] == 0) ++ties[edge.a];
  }
  const auto most = std::max_element(ties.begin(), ties.end());
  if (*most > 1) {
    EXPECT_EQ(tree.vertex[0], static_cast<std::uint32_t>(most - ties.begin()));
    return;
  }
  for (const Edge& edge : g.edges)
    for (const auto& [fixed, own] : {std::pair{edge.a, edge.b}, std::pair{edge.b, edge.a}})
      if (g.movable[fixed] == 0) {
        EXPECT_EQ(tree.vertex[0], own);
        return;
      }
  const auto children = std::count(tree.parent.begin() + 1, tree.parent.end(), 0u);
  EXPECT_LE(children, 1) << "without ties an end";
}

TEST(TreesOf, RandomTreesAreNumberedAsPromised) {
  Random random(7);
  for (int round = 0; round < test::scaled(400); ++round) {
    const Scene scene = test::random_tree(random, {.movable = 1 + test::below(random, 60),
                                                   .anchors = test::below(random, 6),
                                                   .straggling = round % 2 == 0});
    const LocalGraph g = graph_of(scene);
    const auto tree = find_tree(g.view());
    ASSERT_TRUE(tree) << "round " << round;
    expect_numbers(*tree, g);
    expect_root(*tree, g);
  }
}

TEST(TreesOf, OneMoreRodBetweenMovableParticlesIsACycle) {
  Random random(8);
  for (int round = 0; round < test::scaled(400); ++round) {
    const Scene scene = test::random_tree(
        random, {.movable = 2 + test::below(random, 40), .anchors = test::below(random, 4)});
    LocalGraph g = graph_of(scene);
    Ids movable;
    for (std::uint32_t v = 0; v < g.movable.size(); ++v)
      if (g.movable[v] != 0) movable.push_back(v);
    test::shuffle(movable, random);
    g.edges.insert(g.edges.begin() + test::below(random, static_cast<std::uint32_t>(g.edges.size()) + 1),
                   {movable[0], movable[1]});
    EXPECT_FALSE(find_tree(g.view())) << "round " << round;
  }
}

// Of random graphs, cut into islands: a tree where an island has one rod between movable particles less than
// such particles.
TEST(TreesOf, IslandsOfGraphsAreTreesByTheirCount) {
  Random random(9);
  int trees = 0, others = 0;
  for (int round = 0; round < test::scaled(200); ++round) {
    const LocalGraph whole = test::random_graph(random, 60, 40 + test::below(random, 40));
    const Islands islands = find_islands(whole.view());
    for (std::uint32_t i = 0; i < islands.count(); ++i) {
      const LocalGraph g = local_graph(whole.view(), islands, i);
      const auto movable = std::count(g.movable.begin(), g.movable.end(), 1);
      const auto between = std::count_if(g.edges.begin(), g.edges.end(), [&](const Edge& e) {
        return g.movable[e.a] != 0 && g.movable[e.b] != 0;
      });
      const auto tree = find_tree(g.view());
      ASSERT_EQ(tree.has_value(), between == movable - 1);
      if (tree) expect_numbers(*tree, g);
      ++(tree ? trees : others);
    }
  }
  EXPECT_GT(trees, test::scaled(500));
  EXPECT_GT(others, test::scaled(50));
}

}  // namespace
}  // namespace plumb::layouts::PLUMB_TEST_FILE
