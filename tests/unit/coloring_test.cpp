#include "plumb/layouts/coloring.hpp"

#include <gtest/gtest.h>

#include <cstdint>

#include "plumb/layouts/islands.hpp"

namespace plumb::layouts::PLUMB_TEST_FILE {
namespace {

using Colors = Array<std::uint32_t>;

TEST(Coloring, OfNothingHasNoColors) {
  const Coloring coloring = color_edges({});
  EXPECT_EQ(coloring.colors, 0u);
  EXPECT_TRUE(coloring.color_of_edge.empty());
  EXPECT_TRUE(is_valid({}, coloring));
}

TEST(Coloring, OfAChainAlternates) {
  const LocalGraph g{{{0, 1}, {1, 2}, {2, 3}, {3, 4}}, {1, 1, 1, 1, 1}};
  const Coloring coloring = color_edges(g.view());
  EXPECT_EQ(coloring.color_of_edge, (Colors{0, 1, 0, 1}));
  EXPECT_EQ(coloring.colors, 2u);
}

TEST(Coloring, GivesEveryEdgeOfAHubItsOwnColor) {
  constexpr std::uint32_t spokes = 50'000;  // a search per edge would cost 10⁹ steps
  LocalGraph g;
  for (std::uint32_t i = 1; i <= spokes; ++i) g.edges.push_back({0, i});
  g.movable.assign(spokes + 1, 1);
  const Coloring coloring = color_edges(g.view());
  EXPECT_EQ(coloring.colors, spokes);
  EXPECT_TRUE(is_valid(g.view(), coloring));
}

TEST(Coloring, LetsEdgesShareAFixedVertex) {
  const LocalGraph g{{{0, 1}, {0, 2}, {3, 0}}, {0, 1, 1, 1}};
  const Coloring coloring = color_edges(g.view());
  EXPECT_EQ(coloring.color_of_edge, (Colors{0, 0, 0}));
  EXPECT_EQ(coloring.colors, 1u);
}

TEST(Coloring, TakesTheLeastUsedColor) {
  // A path opens colours 0 and 1; two separate edges go to 0 and 1, least used first, lowest of equals.
  const LocalGraph g{{{0, 1}, {1, 2}, {2, 3}, {4, 5}, {6, 7}, {8, 9}}, Array<std::uint8_t>(10, 1)};
  const Coloring coloring = color_edges(g.view());
  EXPECT_EQ(coloring.color_of_edge, (Colors{0, 1, 0, 1, 0, 1}));
}

TEST(IsValid, RefusesNeighborsOfOneColor) {
  const LocalGraph g{{{0, 1}, {1, 2}}, {1, 1, 1}};
  EXPECT_TRUE(is_valid(g.view(), {{0, 1}, 2}));
  EXPECT_FALSE(is_valid(g.view(), {{1, 1}, 2}));
  const LocalGraph held{g.edges, {1, 0, 1}};
  EXPECT_TRUE(is_valid(held.view(), {{1, 1}, 2}));
}

TEST(IsValid, RefusesMissingAndUnknownColors) {
  const LocalGraph g{{{0, 1}, {1, 2}}, {1, 1, 1}};
  EXPECT_FALSE(is_valid(g.view(), {{0}, 2}));
  EXPECT_FALSE(is_valid(g.view(), {{0, 2}, 2}));
}

}  // namespace
}  // namespace plumb::layouts::PLUMB_TEST_FILE
