#include "plumb/layouts/trees.hpp"

#include <gtest/gtest.h>

#include <cstdint>

#include "plumb/layouts/islands.hpp"

namespace plumb::layouts::PLUMB_TEST_FILE {
namespace {

using Ids = Array<std::uint32_t>;

TEST(Trees, AChainIsNumberedFromItsTie) {
  // [3] - 2 - 0 - 1, edges in no order: the root is the vertex at the tie.
  const LocalGraph g{{{0, 1}, {3, 2}, {2, 0}}, {1, 1, 1, 0}};
  const auto tree = find_tree(g.view());
  ASSERT_TRUE(tree);
  EXPECT_EQ(tree->vertex, (Ids{2, 0, 1}));
  EXPECT_EQ(tree->parent, (Ids{0, 0, 1}));
  EXPECT_EQ((Ids{tree->edge[1], tree->edge[2]}), (Ids{2, 0}));
  EXPECT_EQ(tree->tie_begin, (Ids{0, 1, 1, 1}));
  ASSERT_EQ(tree->ties.size(), 1u);
  EXPECT_EQ(tree->ties[0].vertex, 3u);
  EXPECT_EQ(tree->ties[0].edge, 1u);
}

TEST(Trees, AFreeChainIsNumberedFromAnEnd) {
  const LocalGraph g{{{0, 1}, {0, 2}, {2, 3}}, {1, 1, 1, 1}};  // 1 - 0 - 2 - 3
  const auto tree = find_tree(g.view());
  ASSERT_TRUE(tree);
  EXPECT_EQ(tree->vertex, (Ids{1, 0, 2, 3}));
  EXPECT_EQ(tree->parent, (Ids{0, 0, 1, 2}));
  EXPECT_TRUE(tree->ties.empty());
}

TEST(Trees, TheRootIsWhatTiesHold) {
  // [3] - 0 - 1 - 2, and 2 held by 4, 5 and 6: what hangs from it is eliminated before it.
  const LocalGraph g{{{3, 0}, {0, 1}, {1, 2}, {2, 4}, {2, 5}, {2, 6}}, {1, 1, 1, 0, 0, 0, 0}};
  const auto tree = find_tree(g.view());
  ASSERT_TRUE(tree);
  EXPECT_EQ(tree->vertex, (Ids{2, 1, 0}));
  EXPECT_EQ(tree->tie_begin, (Ids{0, 3, 3, 4}));
}

TEST(Trees, OneVertexIsATree) {
  const LocalGraph loose{{}, {1}};
  const auto tree = find_tree(loose.view());
  ASSERT_TRUE(tree);
  EXPECT_EQ(tree->vertex, (Ids{0}));
  EXPECT_EQ(tree->tie_begin, (Ids{0, 0}));

  const LocalGraph held{{{1, 0}, {0, 2}, {3, 0}}, {1, 0, 0, 0}};
  const auto tied = find_tree(held.view());
  ASSERT_TRUE(tied);
  EXPECT_EQ(tied->tie_begin, (Ids{0, 3}));
  for (std::uint32_t k = 0; k < 3; ++k) {
    EXPECT_EQ(tied->ties[k].vertex, k + 1);
    EXPECT_EQ(tied->ties[k].edge, k) << "in the order of edges";
  }
}

// Branches: depth first, the edge with the smallest number first, so that most parents precede their child.
TEST(Trees, BranchesAreNumberedDepthFirst) {
  //        [5]
  //         |
  //   1 --- 0 --- 3 --- 4
  //         |
  //         2
  const LocalGraph g{{{0, 1}, {0, 2}, {3, 0}, {3, 4}, {5, 0}}, {1, 1, 1, 1, 1, 0}};
  const auto tree = find_tree(g.view());
  ASSERT_TRUE(tree);
  EXPECT_EQ(tree->vertex, (Ids{0, 1, 2, 3, 4}));
  EXPECT_EQ(tree->parent, (Ids{0, 0, 0, 0, 3}));
}

// Fixed vertices do not move, so rods that meet there close nothing: not even two to the same one.
TEST(Trees, TiesCloseNoCycle) {
  const LocalGraph between{{{0, 1}, {2, 0}, {1, 2}}, {1, 1, 0}};
  const auto tree = find_tree(between.view());
  ASSERT_TRUE(tree);
  EXPECT_EQ(tree->nodes(), 2u);
  EXPECT_EQ(tree->tie_begin, (Ids{0, 1, 2}));
}

TEST(Trees, CyclesAreNone) {
  const LocalGraph ring{{{0, 1}, {1, 2}, {2, 0}}, {1, 1, 1}};
  EXPECT_FALSE(find_tree(ring.view()));
  const LocalGraph hung{{{3, 0}, {0, 1}, {1, 2}, {2, 0}}, {1, 1, 1, 0}};
  EXPECT_FALSE(find_tree(hung.view()));
  const LocalGraph twice{{{0, 1}, {1, 0}}, {1, 1}};
  EXPECT_FALSE(find_tree(twice.view()));
  // A tackle may hold together what rods do not. Here they have the number of a tree's.
  for (const bool is_tied : {false, true}) {
    LocalGraph parts{{{0, 1}, {1, 2}, {2, 0}, {3, 4}}, {1, 1, 1, 1, 1, 0}};
    if (is_tied) parts.edges.push_back({0, 5});
    EXPECT_FALSE(find_tree(parts.view()));
  }
}

}  // namespace
}  // namespace plumb::layouts::PLUMB_TEST_FILE
