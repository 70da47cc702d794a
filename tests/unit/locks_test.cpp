// Which particles straight lines lock, and the orders that factorisations eliminate in.

#include "direct/locks/locks.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <numeric>
#include <vector>

#include "direct/loops/loop_state.hpp"
#include "linear/elimination_order.hpp"

namespace plumb::detail::PLUMB_TEST_FILE {
namespace {

/// Three nodes in a line between two anchors, which are vertices 3 and 4, with rods of 1 m.
LoopState line(double span) {
  LoopState state(std::make_shared<LoopTopology>(3, 5, Array<LoopRod>{{0, 3}, {0, 1}, {1, 2}, {2, 4}}));
  for (const std::uint32_t vertex : {0u, 1u, 2u, 3u, 4u})
    state.x[3 * vertex] = vertex < 3 ? (vertex + 1) * span / 4 : vertex == 4 ? span : 0;
  std::fill(state.length2.begin(), state.length2.end(), 1.0);
  return state;
}

TEST(Locks, AreWhereALineIsAsLongAsItsAnchorsAreApart) {
  LoopState taut = line(4);
  taut.locks = find_locks(taut);
  for (const std::uint32_t node : {0u, 1u, 2u}) EXPECT_TRUE(taut.locks.has(node)) << node;
  EXPECT_FALSE(find_locks(line(4 - 1e-6)).any()) << "slack";
  EXPECT_FALSE(find_locks(line(4 + 1e-6)).any()) << "too short";
}

TEST(Locks, HoldWhileAnchorsMoveAlike) {
  LoopState state = line(4);
  state.locks = find_locks(state);
  state.fixed_velocity = {{1, 2, 0}, {1, 2, 0}};
  EXPECT_TRUE(locks_hold(state));
  EXPECT_EQ(locked_velocity(state, 1), (Vec3{1, 2, 0}));
  state.fixed_velocity[1] = {-1, 2, 0};
  EXPECT_FALSE(locks_hold(state));
}

TEST(EliminationOrder, HasEveryNodeOnce) {
  std::vector<std::pair<std::uint32_t, std::uint32_t>> edges;
  for (std::uint32_t i = 0; i < 100; ++i) edges.emplace_back(i, (i + 1) % 100);
  Array<std::uint32_t> all(100);
  std::iota(all.begin(), all.end(), 0u);
  for (auto order : {order_by_degree(100, edges), order_by_dissection(100, edges)}) {
    std::sort(order.begin(), order.end());
    EXPECT_EQ(order, all);
  }
}

}  // namespace
}  // namespace plumb::detail::PLUMB_TEST_FILE
