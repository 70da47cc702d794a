// How much of what sweeps left before a substep takes back.

#include "time/leftovers.hpp"

#include <gtest/gtest.h>

#include <cmath>

namespace plumb::detail::PLUMB_TEST_FILE {
namespace {

TEST(Leftovers, AreTakenBackWholeByWhatIsAsLong) {
  const double h = 1.0 / 60;
  Leftovers leftovers;
  EXPECT_EQ(leftovers.share(h), 1) << "nothing is left before the first substep";
  for (int i = 0; i < 3; ++i) {
    leftovers.pass(h, 8);
    EXPECT_EQ(leftovers.share(h), 1) << "of equal substeps";
    EXPECT_EQ(leftovers.share(2 * h), 1) << "of a longer one";
    EXPECT_DOUBLE_EQ(leftovers.share(h / 4), 1.0 / 16);
    EXPECT_DOUBLE_EQ(leftovers.share(h / 16), 1.0 / 256);
    EXPECT_DOUBLE_EQ(leftovers.share(h / 160), 1.0 / 2560);
  }
}

// Squares of substeps are lost by a quarter of what passes: 12 of half the length make the whole theirs.
TEST(Leftovers, FadeWhileSubstepsAreShort) {
  Leftovers leftovers{1};
  leftovers.pass(0.5, 4);
  EXPECT_EQ(leftovers.square, 0.75);
  leftovers.pass(0.5, 7);
  EXPECT_LT(leftovers.share(0.5), 1);
  leftovers.pass(0.5);
  EXPECT_EQ(leftovers.share(0.5), 1);
  leftovers.pass(0.5, 100);
  EXPECT_EQ(leftovers.square, 0.25);
}

// However short substeps are, what was left halves in the same time, 64 ln 2 of the substep that left it.
TEST(Leftovers, FadeInATimeThatDoesNotGrow) {
  for (const double h : {1e-3, 1e-4, 1e-5}) {
    Leftovers leftovers{1};
    std::uint32_t substeps = 0;
    for (; leftovers.square > 0.25; ++substeps) leftovers.pass(h);
    EXPECT_NEAR(substeps * h, 64, 0.1) << h;
  }
}

}  // namespace
}  // namespace plumb::detail::PLUMB_TEST_FILE
