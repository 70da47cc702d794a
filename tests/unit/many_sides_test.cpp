// A long chain that touches itself in more places than its responses are kept of.

#include <gtest/gtest.h>

#include "fall/measure.hpp"

namespace plumb::tools::PLUMB_TEST_FILE {
namespace {

TEST(ManySides, OfALongCoilAreSolvedAnew) {
  const Fall fall{.scene = "rope:links=1000,coil=0.3,pitch=0.3",
                  .settings = {.method = Method::direct, .threads = 1},
                  .frames = 34};
  const FallResult result = run_fall(fall);
  EXPECT_TRUE(result.finite);
  EXPECT_GT(result.total.contact_points, 40u) << "and so a hundred sides";
  EXPECT_EQ(result.total.unsolved, 0u);
  // Pushes that were lost or stale would leave substeps to be cut, down to what is given up.
  EXPECT_LT(result.total.fallbacks, 10u);
  EXPECT_LT(result.stretch, 1e-7);
  EXPECT_LT(result.depth, 1e-3);
}

}  // namespace
}  // namespace plumb::tools::PLUMB_TEST_FILE
