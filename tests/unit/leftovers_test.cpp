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

// A substep of half the length takes back a quarter of what it finds, and of what was kept another quarter.
// What is on the other side of a rod's length, or closer to it, is not pulled away from there.
TEST(Keeping, KeepsNoMoreThanThereIs) {
  Leftovers leftovers;
  leftovers.pass(1e-2);
  const Keeping<double> half(leftovers, 5e-3), whole(leftovers, 1e-2);
  EXPECT_DOUBLE_EQ(half.of(1, 0), 9.0 / 16);
  EXPECT_DOUBLE_EQ(half.of(-1, 0), -9.0 / 16);
  EXPECT_DOUBLE_EQ(half.of(1, 1), 3.0 / 4);
  EXPECT_EQ(half.of(0.1, 10), 0.1);
  EXPECT_EQ(half.of(0.1, -10), 0);
  EXPECT_EQ(whole.of(1, 1), 0);
}

// A blow of a short substep is over, while what rests in equal ones or before a frame that hangs presses on.
TEST(Leftovers, TakeForcesOfShortSubstepsForImpulses) {
  Leftovers leftovers;
  EXPECT_EQ(leftovers.force_share(1e-2), 1);
  leftovers.pass(1e-2);
  EXPECT_EQ(leftovers.force_share(1e-2), 1);
  EXPECT_EQ(leftovers.force_share(0.25), 1);
  leftovers.pass(5e-3);
  EXPECT_EQ(leftovers.force_share(1e-2), 1);
  leftovers.pass(1e-3);
  EXPECT_EQ(leftovers.force_share(1e-3), 1);
  EXPECT_DOUBLE_EQ(leftovers.force_share(0.25), 2e-3 / leftovers.time);
}

// An edit goes on with what the longest has left, as if nothing had been taken back.
TEST(Leftovers, GoOnWithTheLongest) {
  Leftovers leftovers, longer;
  leftovers.pass(1e-3);
  longer.pass(1e-2);
  longer.pass(2e-3);
  leftovers.go_on(longer);
  EXPECT_EQ(leftovers.time, longer.time);
  EXPECT_EQ(leftovers.last, longer.time);
  leftovers.go_on({});
  EXPECT_EQ(leftovers.time, longer.time);
}

}  // namespace
}  // namespace plumb::detail::PLUMB_TEST_FILE
