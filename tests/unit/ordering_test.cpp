#include "plumb/layouts/ordering.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cstdint>

#include "plumb/layouts/islands.hpp"

namespace plumb::layouts::PLUMB_TEST_FILE {
namespace {

using Ids = Array<std::uint32_t>;

TEST(Bandwidth, IsTheLongestEdgeInTheOrder) {
  const LocalGraph g{{{0, 1}, {3, 1}}, {1, 1, 1, 1}};
  EXPECT_EQ(bandwidth(g.view(), Ids{0, 1, 2, 3}), 2u);
  EXPECT_EQ(bandwidth(g.view(), Ids{0, 2, 3, 1}), 3u);
  EXPECT_EQ(bandwidth(g.view(), Ids{2, 0, 1, 3}), 1u);
}

TEST(Bandwidth, IsZeroWithoutEdges) {
  const LocalGraph g{{}, {1, 1, 1}};
  EXPECT_EQ(bandwidth(g.view(), Ids{2, 0, 1}), 0u);
}

TEST(Order, OfNothingIsEmpty) {
  EXPECT_TRUE(bandwidth_reducing_order({}).empty());
}

TEST(Order, UntanglesAChain) {
  const LocalGraph g{{{4, 2}, {2, 0}, {0, 3}, {3, 1}}, {1, 1, 1, 1, 1}};
  const Ids order = bandwidth_reducing_order(g.view());
  ASSERT_EQ(order.size(), 5u);
  EXPECT_EQ(bandwidth(g.view(), order), 1u);
}

TEST(Order, KeepsAnchorsAtTheEndsOfAChain) {
  // [5] - 2 - 0 - 3 - 1 - [4]
  const LocalGraph g{{{5, 2}, {2, 0}, {0, 3}, {3, 1}, {1, 4}}, {1, 1, 1, 1, 0, 0}};
  EXPECT_EQ(bandwidth(g.view(), bandwidth_reducing_order(g.view())), 1u);
}

TEST(Order, StaysIfThereIsNothingToGain) {
  const LocalGraph chain{{{0, 1}, {1, 2}, {2, 3}}, {0, 1, 1, 1}};
  EXPECT_EQ(bandwidth_reducing_order(chain.view()), (Ids{0, 1, 2, 3}));
  // A net of 3 × 4, row by row: levels from a corner would be no narrower.
  LocalGraph net;
  Ids given;
  for (std::uint32_t v = 0; v < 12; ++v) {
    if (v % 3 < 2) net.edges.push_back({v, v + 1});
    if (v < 9) net.edges.push_back({v, v + 3});
    given.push_back(v);
  }
  net.movable.assign(12, 1);
  EXPECT_EQ(bandwidth_reducing_order(net.view()), given);
}

TEST(Order, HoldsUntouchedVerticesAndSeveralComponents) {
  // Chains 0 - 5 - 2 and 1 - 4; 3 is fixed and untouched, 6 movable and untouched.
  const LocalGraph g{{{0, 5}, {5, 2}, {1, 4}}, {1, 1, 1, 0, 1, 1, 1}};
  Ids order = bandwidth_reducing_order(g.view());
  EXPECT_EQ(bandwidth(g.view(), order), 1u);
  std::sort(order.begin(), order.end());
  EXPECT_EQ(order, (Ids{0, 1, 2, 3, 4, 5, 6}));
}

TEST(Order, IsNotDisturbedByAnAnchorThatHoldsEverything) {
  // A long chain, shuffled by a stride, with every tenth vertex tied to one anchor. Edges to the anchor are
  // long in any order, shortest with the anchor in the middle, where it is given; the chain's own must not
  // be.
  constexpr std::uint32_t link_count = 200;
  constexpr std::uint32_t stride = 77;  // coprime to 200
  constexpr std::uint32_t anchor = 100;
  const auto id = [](std::uint32_t i) {
    const std::uint32_t shuffled = i * stride % link_count;
    return shuffled < anchor ? shuffled : shuffled + 1;
  };
  LocalGraph chain;
  for (std::uint32_t i = 0; i + 1 < link_count; ++i) chain.edges.push_back({id(i), id(i + 1)});
  chain.movable.assign(link_count + 1, 1);
  chain.movable[anchor] = 0;
  LocalGraph all = chain;
  for (std::uint32_t i = 0; i < link_count; i += 10) all.edges.push_back({anchor, id(i)});
  // One apart, or two where the anchor stands between.
  EXPECT_LE(bandwidth(chain.view(), bandwidth_reducing_order(all.view())), 2u);
}

TEST(Order, KeepsChainsOfOneAnchorApart) {
  // Vertex i of chain c has id 5 i + c: given side by side, five wide. All hang from 50.
  constexpr std::uint32_t chain_count = 5;
  constexpr std::uint32_t chain_length = 10;
  constexpr std::uint32_t anchor = chain_count * chain_length;
  LocalGraph chains;
  for (std::uint32_t v = chain_count; v < anchor; ++v) chains.edges.push_back({v - chain_count, v});
  chains.movable.assign(anchor + 1, 1);
  chains.movable[anchor] = 0;
  LocalGraph all = chains;
  for (std::uint32_t c = 0; c < chain_count; ++c) all.edges.push_back({anchor - 1 - c, anchor});
  EXPECT_LE(bandwidth(chains.view(), bandwidth_reducing_order(all.view())), 2u);
}

}  // namespace
}  // namespace plumb::layouts::PLUMB_TEST_FILE
