// How much shorter substeps keep of what a longer one left.

#include "time/leftovers.hpp"

#include <gtest/gtest.h>

#include <array>

namespace plumb::detail::PLUMB_TEST_FILE {
namespace {

TEST(Leftovers, AreNoneOfWhatIsAsLong) {
  const double h = 1.0 / 60;
  Leftovers leftovers;
  EXPECT_EQ(leftovers.keeps(h), 0) << "before the first substep";
  for (int i = 0; i < 3; ++i) {
    leftovers.pass(h);
    EXPECT_FALSE(leftovers.any());
    for (const double next : {h, 2 * h, 0.95 * h})
      EXPECT_EQ(leftovers.keeps(next), 0) << "frames differ a little";
    EXPECT_DOUBLE_EQ(leftovers.keeps(h / 4), 15.0 / 16) << "it takes back what one of its length leaves";
  }
}

// Once they are equal, short substeps take back all that they leave. What was kept fades by as much as one of
// their length leaves, or in sixteen times what left it, or in half a second.
TEST(Leftovers, OfShortSubstepsAreTheirOwn) {
  for (const auto& [time, h, share] : {std::array{1.0 / 60, 1.0 / 240, 1.0 / 16},
                                       std::array{0.01, 1e-4, 1e-4 / 0.16}, std::array{1.0, 1e-3, 2e-3}}) {
    Leftovers leftovers;
    leftovers.pass(time);
    EXPECT_DOUBLE_EQ(leftovers.fades(h), share);
    leftovers.pass(h);
    EXPECT_TRUE(leftovers.any());
    EXPECT_EQ(leftovers.keeps(h), 0) << "of what it left itself";
    EXPECT_EQ(leftovers.fades(time), 1) << "by one that is as long as what left it";
  }
}

// Where steps are ever shorter, less than a hundredth is left when they take over, and that within three
// times of the half second.
TEST(Leftovers, EndOnceTheyHaveFaded) {
  for (const double h : {1.0 / 60, 1e-3, 1e-4}) {
    Leftovers leftovers;
    leftovers.pass(1);
    double left = 1, passed = 0;
    do {
      left *= 1 - leftovers.fades(h);
      leftovers.pass(h);
      passed += h;
    } while (leftovers.any());
    EXPECT_LT(left, 0.01) << h;
    EXPECT_LT(passed, 6) << h;
  }
}

}  // namespace
}  // namespace plumb::detail::PLUMB_TEST_FILE
