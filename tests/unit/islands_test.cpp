#include "plumb/layouts/islands.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cstdint>

namespace plumb::layouts::PLUMB_TEST_FILE {
namespace {

using Ids = Array<std::uint32_t>;

Ids vertices_of(const Islands& islands, std::uint32_t island) {
  const auto vertices = islands.vertices(island);
  return {vertices.begin(), vertices.end()};
}

Ids edges_of(const Islands& islands, std::uint32_t island) {
  const auto edges = islands.edges(island);
  return {edges.begin(), edges.end()};
}

TEST(Islands, AnEmptyGraphHasNone) {
  EXPECT_EQ(find_islands({}).count(), 0u);
  EXPECT_TRUE(group_equal_islands({}, find_islands({})).empty());
  EXPECT_EQ(Islands{}.count(), 0u);
}

TEST(Islands, FixedVerticesDoNotConnect) {
  // 0 - 1 - [2] - 3 - 4: two islands that hang from the same fixed vertex.
  const LocalGraph g{{{0, 1}, {1, 2}, {2, 3}, {3, 4}}, {1, 1, 0, 1, 1}};
  const Islands islands = find_islands(g.view());
  ASSERT_EQ(islands.count(), 2u);
  EXPECT_EQ(vertices_of(islands, 0), (Ids{0, 1, 2}));
  EXPECT_EQ(edges_of(islands, 0), (Ids{0, 1}));
  EXPECT_EQ(vertices_of(islands, 1), (Ids{3, 4, 2}));
  EXPECT_EQ(edges_of(islands, 1), (Ids{2, 3}));
}

TEST(Islands, AreOrderedByTheirSmallestMovableVertex) {
  // {1, 4}, {2, 5} and {3}; edges and their directions in no order, fixed 0 touched last.
  const LocalGraph g{{{5, 2}, {4, 1}, {0, 5}}, {0, 1, 1, 1, 1, 1}};
  const Islands islands = find_islands(g.view());
  ASSERT_EQ(islands.count(), 3u);
  EXPECT_EQ(vertices_of(islands, 0), (Ids{1, 4}));
  EXPECT_EQ(edges_of(islands, 0), (Ids{1}));
  EXPECT_EQ(vertices_of(islands, 1), (Ids{2, 5, 0}));
  EXPECT_EQ(edges_of(islands, 1), (Ids{0, 2}));
  EXPECT_EQ(vertices_of(islands, 2), (Ids{3}));
  EXPECT_TRUE(edges_of(islands, 2).empty());
}

TEST(Islands, ListEachFixedVertexOnceAndUntouchedOnesNowhere) {
  // A ring 1 - 2 - 3 held twice by 5 and once by 4; 0 is touched by nothing.
  const LocalGraph g{{{5, 1}, {1, 2}, {2, 3}, {3, 1}, {3, 5}, {2, 4}}, {0, 1, 1, 1, 0, 0}};
  const Islands islands = find_islands(g.view());
  ASSERT_EQ(islands.count(), 1u);
  EXPECT_EQ(vertices_of(islands, 0), (Ids{1, 2, 3, 4, 5}));
  EXPECT_EQ(edges_of(islands, 0), (Ids{0, 1, 2, 3, 4, 5}));
}

TEST(Islands, AnEdgeBetweenFixedVerticesBelongsToNone) {
  const LocalGraph g{{{0, 1}, {1, 2}}, {0, 0, 1}};
  const Islands islands = find_islands(g.view());
  ASSERT_EQ(islands.count(), 1u);
  EXPECT_EQ(vertices_of(islands, 0), (Ids{2, 1}));
  EXPECT_EQ(edges_of(islands, 0), (Ids{1}));
}

TEST(LocalGraph, NumbersMovableVerticesFirst) {
  const LocalGraph g{{{0, 3}, {3, 1}, {2, 1}, {4, 2}}, {0, 1, 0, 1, 1}};
  const Islands islands = find_islands(g.view());
  ASSERT_EQ(islands.count(), 2u);
  // Island {1, 3}: vertices 1, 3, then the fixed 0, 2.
  const LocalGraph local = local_graph(g.view(), islands, 0);
  EXPECT_EQ(local.movable, (Array<std::uint8_t>{1, 1, 0, 0}));
  EXPECT_EQ(local.edges, (Array<Edge>{{2, 1}, {1, 0}, {3, 0}}));
  const LocalGraph other = local_graph(g.view(), islands, 1);
  EXPECT_EQ(other.movable, (Array<std::uint8_t>{1, 0}));
  EXPECT_EQ(other.edges, (Array<Edge>{{0, 1}}));
}

TEST(LocalGraph, ViewShowsTheWholeGraph) {
  const LocalGraph g{{{0, 1}, {1, 2}}, {1, 0, 1}};
  EXPECT_EQ(g.view().vertices, 3u);
  EXPECT_EQ(g.view().edges.size(), 2u);
  EXPECT_EQ(g.view().movable[1], 0);
}

TEST(EqualIslands, AreGroupedWhateverLiesBetweenThem) {
  // Two rods hanging from [0]; a free rod; two more of the first kind; a lone vertex.
  const LocalGraph g{{{0, 1}, {1, 2}, {3, 4}, {0, 5}, {5, 6}, {0, 7}, {7, 8}},
                     {0, 1, 1, 1, 1, 1, 1, 1, 1, 1}};
  const auto groups = group_equal_islands(g.view(), find_islands(g.view()));
  EXPECT_EQ(groups, (Array<Ids>{{0, 2, 3}, {1}, {4}}));
}

TEST(EqualIslands, DifferByDirectionOrderAndFixedVertices) {
  const LocalGraph g{{
                         {0, 1},
                         {1, 2},  // island 0
                         {3, 4},
                         {5, 4},  // island 1: second edge turned
                         {7, 8},
                         {6, 7},  // island 2: edges in another order
                         {9, 10},
                         {10, 11},  // island 3: last vertex fixed
                         {12, 13}   // island 4: shorter
                     },
                     {1, 1, 1, 1, 1, 1, 1, 1, 1, 1, 1, 0, 1, 1}};
  const auto groups = group_equal_islands(g.view(), find_islands(g.view()));
  EXPECT_EQ(groups, (Array<Ids>{{0}, {1}, {2}, {3}, {4}}));
}

TEST(EqualIslands, AHundredThousandTakeNoQuadraticTime) {
  // Quadratic work would take minutes; the test runner's limit is what fails then.
  constexpr std::uint32_t island_count = 100'000;
  LocalGraph g;
  for (std::uint32_t i = 0; i < island_count; ++i) {
    g.edges.push_back({3 * i, 3 * i + 1});
    g.edges.push_back(i % 2 == 0 ? Edge{3 * i + 1, 3 * i + 2} : Edge{3 * i + 2, 3 * i + 1});
  }
  g.movable.assign(3 * island_count, 1);
  const auto groups = group_equal_islands(g.view(), find_islands(g.view()));
  ASSERT_EQ(groups.size(), 2u);
  EXPECT_EQ(groups[0].size(), island_count / 2);
  EXPECT_EQ(groups[1].size(), island_count / 2);
  EXPECT_EQ(groups[1][1], 3u);
  EXPECT_TRUE(std::is_sorted(groups[0].begin(), groups[0].end()));
}

}  // namespace
}  // namespace plumb::layouts::PLUMB_TEST_FILE
