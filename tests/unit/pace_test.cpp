// How long pieces of substeps are, how much a substep may try, and when an iteration is given up.

#include "time/pace.hpp"

#include <gtest/gtest.h>

#include "stability/hangings/hangings.hpp"
#include "time/effort.hpp"
#include "time/progress.hpp"

namespace plumb::detail::PLUMB_TEST_FILE {
namespace {

// What had to be halved twice is cut into quarters at once, and grows back in three times two quiet pieces.
TEST(Pace, IsAsShortAsWhatWorkedAndGrowsBack) {
  Pace pace;
  EXPECT_EQ(pace.cuts(1), 0);
  pace.took(1, 2);
  EXPECT_EQ(pace.cuts(1), 2);
  EXPECT_EQ(pace.cuts(0.25), 0) << "a shorter substep is not cut";
  pace.took(0.25, 0);
  EXPECT_EQ(pace.cuts(1), 2);
  pace.took(0.25, 0);
  EXPECT_EQ(pace.cuts(1), 1);
  pace.took(0.5, 0);
  pace.took(0.5, 0);
  EXPECT_EQ(pace.cuts(1), 0);
  pace.took(1, 20);
  EXPECT_EQ(pace.cuts(1), Pace::most_cuts);
}

// Where growing was too early, twice as many pieces must be taken before the next time.
TEST(Pace, WaitsLongerAfterGrowingInVain) {
  Pace pace;
  pace.took(1, 1);
  for (int i = 0; i < 2; ++i) pace.took(0.5, 0);
  EXPECT_EQ(pace.cuts(1), 0);
  pace.took(1, 1);
  for (int i = 0; i < 3; ++i) pace.took(0.5, 0);
  EXPECT_EQ(pace.cuts(1), 1);
  pace.took(0.5, 0);
  EXPECT_EQ(pace.cuts(1), 0);
}

// It tends to the median, and one blow changes it by a tenth only.
TEST(Effort, GoesByTheUsualWork) {
  Effort effort;
  EXPECT_EQ(effort.most(), Effort::least);
  for (int i = 0; i < 200; ++i) effort.took(50);
  EXPECT_NEAR(effort.usual, 50, 6);
  const double before = effort.usual;
  effort.took(100'000);
  EXPECT_LE(effort.usual, 1.1001 * before);
  EXPECT_GT(effort.most(), Effort::least);
}

// Halving within its patience is progress, and going round in circles is not.
TEST(Progress, EndsCircles) {
  Progress halves(3), circles(3);
  double change = 1;
  for (int i = 0; i < 50; ++i, change /= 1.3) EXPECT_TRUE(halves.goes_on(change)) << i;
  int turns = 0;
  while (circles.goes_on(turns % 2 == 0 ? 1e-5 : 6e-6)) ++turns;
  EXPECT_EQ(turns, 3);
}

// These took 19,421, 4,055, 3,638 and 793 Newton steps and halvings in their worst frames: a bridge of
// cables, one that is too short, a graph of cables and a crane that catches its load.
TEST(Effort, BoundsTheWorstFrames) {
  for (const std::uint64_t seed : {942u, 693u, 969u, 670u}) {
    const scenes::HangingResult result = scenes::hang(seed, 3);
    EXPECT_EQ(result.fault(), "") << seed;
    EXPECT_LE(result.worst_work, 250) << seed;
  }
}

}  // namespace
}  // namespace plumb::detail::PLUMB_TEST_FILE
