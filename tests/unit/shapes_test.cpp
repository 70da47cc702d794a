#include "plumb/layouts/shapes.hpp"

#include <gtest/gtest.h>

#include <cstdint>
#include <numeric>
#include <string>
#include <utility>

#include "plumb/layouts/islands.hpp"

namespace plumb::layouts::PLUMB_TEST_FILE {
namespace {

using Ids = Array<std::uint32_t>;

Ids identity(std::size_t n) {
  Ids ids(n);
  std::iota(ids.begin(), ids.end(), 0u);
  return ids;
}

/// A row-major lattice, edges in the order that ShapeInfo promises. All vertices movable.
LocalGraph lattice(std::uint32_t width, std::uint32_t height) {
  LocalGraph g;
  for (std::uint32_t y = 0; y < height; ++y) {
    for (std::uint32_t x = 0; x + 1 < width; ++x) g.edges.push_back({y * width + x, y * width + x + 1});
  }
  for (std::uint32_t y = 0; y + 1 < height; ++y) {
    for (std::uint32_t x = 0; x < width; ++x) g.edges.push_back({y * width + x, (y + 1) * width + x});
  }
  g.movable.assign(std::size_t{width} * height, 1);
  return g;
}

TEST(Chain, StartsAtTheSmallerEnd) {
  const LocalGraph g{{{2, 0}, {1, 3}, {2, 3}}, {1, 1, 1, 1}};
  const ShapeInfo info = detect_shape(g.view());
  EXPECT_EQ(info.shape, Shape::chain);
  EXPECT_EQ(info.vertex_order, (Ids{0, 2, 3, 1}));
  EXPECT_EQ(info.edge_order, (Ids{0, 2, 1}));
}

TEST(Chain, StartsAtTheFixedEnd) {
  const LocalGraph g{{{0, 1}, {1, 2}, {2, 3}}, {1, 1, 1, 0}};
  const ShapeInfo info = detect_shape(g.view());
  EXPECT_EQ(info.shape, Shape::chain);
  EXPECT_EQ(info.vertex_order, (Ids{3, 2, 1, 0}));
  EXPECT_EQ(info.edge_order, (Ids{2, 1, 0}));
}

TEST(Chain, MayBeFixedAtBothEnds) {
  const LocalGraph g{{{3, 0}, {0, 1}, {1, 2}}, {1, 1, 0, 0}};
  const ShapeInfo info = detect_shape(g.view());
  EXPECT_EQ(info.shape, Shape::chain);
  EXPECT_EQ(info.vertex_order, (Ids{2, 1, 0, 3}));
  EXPECT_EQ(info.edge_order, (Ids{2, 1, 0}));
}

TEST(Chain, MayReturnToItsFixedVertex) {
  const LocalGraph g{{{0, 1}, {2, 0}, {1, 2}}, {1, 1, 0}};
  const ShapeInfo info = detect_shape(g.view());
  EXPECT_EQ(info.shape, Shape::chain);
  EXPECT_EQ(info.vertex_order, (Ids{2, 0, 1, 2}));
  EXPECT_EQ(info.edge_order, (Ids{1, 0, 2}));
}

TEST(Chain, MayBeASingleRod) {
  const LocalGraph g{{{1, 0}}, {1, 1}};
  const ShapeInfo info = detect_shape(g.view());
  EXPECT_EQ(info.shape, Shape::chain);
  EXPECT_EQ(info.vertex_order, (Ids{0, 1}));
}

TEST(Chain, IsNotAPointAForkOrARing) {
  EXPECT_EQ(detect_shape(LocalGraph{{}, {1}}.view()).shape, Shape::graph);
  EXPECT_EQ(detect_shape(LocalGraph{{{0, 1}, {0, 2}, {0, 3}}, {1, 1, 1, 1}}.view()).shape, Shape::graph);
  EXPECT_EQ(detect_shape(LocalGraph{{{0, 1}, {1, 2}, {2, 0}}, {1, 1, 1}}.view()).shape, Shape::graph);
  // A movable vertex between three fixed ones.
  EXPECT_EQ(detect_shape(LocalGraph{{{0, 1}, {0, 2}, {0, 3}}, {1, 0, 0, 0}}.view()).shape, Shape::graph);
}

TEST(Chain, DoesNotPassThroughAFixedVertexOrLeaveSomethingOut) {
  EXPECT_EQ(detect_shape(LocalGraph{{{0, 1}, {1, 2}}, {1, 0, 1}}.view()).shape, Shape::graph);
  // A path beside a ring, and a path beside an untouched vertex.
  EXPECT_EQ(detect_shape(LocalGraph{{{0, 1}, {2, 3}, {3, 4}, {4, 2}}, {1, 1, 1, 1, 1}}.view()).shape,
            Shape::graph);
  EXPECT_EQ(detect_shape(LocalGraph{{{0, 1}}, {1, 1, 0}}.view()).shape, Shape::graph);
}

TEST(Shape, OfAGraphHasNoOrders) {
  const ShapeInfo info = detect_shape(LocalGraph{{{0, 1}, {1, 2}, {2, 0}}, {1, 1, 1}}.view());
  EXPECT_TRUE(info.vertex_order.empty());
  EXPECT_TRUE(info.edge_order.empty());
  EXPECT_EQ(info.width, 0u);
}

struct Size {
  std::uint32_t width, height;
};

class RowMajorGrid : public testing::TestWithParam<Size> {};

TEST_P(RowMajorGrid, KeepsItsOrder) {
  const auto [width, height] = GetParam();
  const LocalGraph g = lattice(width, height);
  const ShapeInfo info = detect_shape(g.view());
  ASSERT_EQ(info.shape, Shape::grid);
  EXPECT_EQ(info.width, width);
  EXPECT_EQ(info.height, height);
  EXPECT_EQ(info.vertex_order, identity(g.movable.size()));
  EXPECT_EQ(info.edge_order, identity(g.edges.size()));
}

class HangingNet : public testing::TestWithParam<Size> {};

TEST_P(HangingNet, KeepsItsOrderWhateverCornersAreFixed) {
  const auto [width, height] = GetParam();
  for (unsigned fixed = 1; fixed < 16; ++fixed) {
    // Rods between two fixed particles do not exist.
    const bool neighbors_are_fixed = height == 2 && ((fixed & fixed >> 2) != 0);
    if (neighbors_are_fixed) continue;
    LocalGraph g = lattice(width, height);
    const std::uint32_t vertices = width * height;
    const Ids corners{0, width - 1, vertices - width, vertices - 1};
    for (unsigned corner = 0; corner < 4; ++corner) {
      if ((fixed >> corner & 1) != 0) g.movable[corners[corner]] = 0;
    }
    const ShapeInfo info = detect_shape(g.view());
    ASSERT_EQ(info.shape, Shape::grid);
    EXPECT_EQ(info.vertex_order, identity(vertices));

    // As an island of its own the fixed corners have the last ids; the order in the scene is still kept.
    const Islands islands = find_islands(g.view());
    ASSERT_EQ(islands.count(), 1u);
    const ShapeInfo local = detect_shape(local_graph(g.view(), islands, 0).view());
    ASSERT_EQ(local.shape, Shape::grid);
    EXPECT_EQ(local.width, width);
    Ids scene_order;
    for (const std::uint32_t v : local.vertex_order) scene_order.push_back(islands.vertices(0)[v]);
    EXPECT_EQ(scene_order, identity(vertices)) << "corners " << fixed;
    EXPECT_EQ(local.edge_order, identity(g.edges.size()));
  }
}

std::string name_of(const testing::TestParamInfo<Size>& test) {
  return std::to_string(test.param.width) + "x" + std::to_string(test.param.height);
}
INSTANTIATE_TEST_SUITE_P(Sizes, RowMajorGrid,
                         testing::Values(Size{2, 2}, Size{2, 3}, Size{3, 2}, Size{2, 9}, Size{9, 2},
                                         Size{3, 3}, Size{5, 4}, Size{4, 7}, Size{32, 32}),
                         name_of);
INSTANTIATE_TEST_SUITE_P(Sizes, HangingNet,
                         testing::Values(Size{3, 2}, Size{9, 2}, Size{3, 3}, Size{3, 8}, Size{8, 3},
                                         Size{5, 4}, Size{4, 7}, Size{32, 32}),
                         name_of);

TEST(Grid, NumberedColumnByColumnHasRowsAlongTheIds) {
  // 3 columns of 5: (x, y) has id 5x + y, so rows of five follow the ids.
  LocalGraph g = lattice(3, 5);
  for (Edge& edge : g.edges) edge = {edge.a % 3 * 5 + edge.a / 3, edge.b % 3 * 5 + edge.b / 3};
  const ShapeInfo info = detect_shape(g.view());
  ASSERT_EQ(info.shape, Shape::grid);
  EXPECT_EQ(info.width, 5u);
  EXPECT_EQ(info.height, 3u);
  EXPECT_EQ(info.vertex_order, identity(15));
}

TEST(Grid, HasFourEqualVerticesAtLeast) {
  EXPECT_EQ(detect_shape(lattice(2, 2).view()).shape, Shape::grid);
  // One of the four fixed: a chain from it back to it.
  LocalGraph hung = lattice(2, 2);
  hung.movable[3] = 0;
  const ShapeInfo info = detect_shape(hung.view());
  EXPECT_EQ(info.shape, Shape::chain);
  EXPECT_EQ(info.vertex_order.front(), 3u);
  EXPECT_EQ(info.vertex_order.back(), 3u);
}

TEST(Grid, IsNotAGridWithADiagonalOrACutOrATwist) {
  LocalGraph diagonal = lattice(4, 4);
  diagonal.edges.push_back({5, 10});
  EXPECT_EQ(detect_shape(diagonal.view()).shape, Shape::graph);

  LocalGraph cut = lattice(4, 4);
  cut.edges.erase(cut.edges.begin() + 4);
  EXPECT_EQ(detect_shape(cut.view()).shape, Shape::graph);

  // Two horizontal edges in the middle of a row swap ends: the degrees stay those of a lattice.
  LocalGraph twisted = lattice(4, 4);
  Edge& upper = twisted.edges[4];  // (0, 1)-(1, 1)
  Edge& lower = twisted.edges[7];  // (0, 2)-(1, 2)
  std::swap(upper.b, lower.b);
  EXPECT_EQ(detect_shape(twisted.view()).shape, Shape::graph);

  // A cut mended by doubling a neighbour: as many edges as a lattice.
  LocalGraph doubled = lattice(4, 4);
  doubled.edges[5] = doubled.edges[4];
  EXPECT_EQ(detect_shape(doubled.view()).shape, Shape::graph);
}

TEST(Grid, IsNotATubeOrTwoGrids) {
  // A 4 × 3 lattice rolled up: four vertices around, three along.
  LocalGraph tube = lattice(4, 3);
  for (std::uint32_t y = 0; y < 3; ++y) tube.edges.push_back({4 * y + 3, 4 * y});
  EXPECT_EQ(detect_shape(tube.view()).shape, Shape::graph);

  LocalGraph two = lattice(2, 2);
  for (const Edge& edge : lattice(2, 2).edges) two.edges.push_back({edge.a + 4, edge.b + 4});
  two.movable.resize(8, 1);
  EXPECT_EQ(detect_shape(two.view()).shape, Shape::graph);
}

}  // namespace
}  // namespace plumb::layouts::PLUMB_TEST_FILE
