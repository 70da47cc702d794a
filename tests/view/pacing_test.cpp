// Simulated time keeps pace with the clock, whatever the clock of the waiting thread does to single frames.
#include "view/server/pacing.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <random>

namespace plumb::view::PLUMB_TEST_FILE {
namespace {

using std::chrono::microseconds;
using Time = Pacing::Time;

struct Paced {
  double pace = 0;   ///< Simulated seconds per second of the clock.
  double shown = 0;  ///< Mean of what was shown after the first second.
};

/// Runs frames whose steps take `work`, in a thread that wakes late by up to `late`.
Paced run(double speed, microseconds work, microseconds late, int frames) {
  constexpr double length = 1.0 / 60;
  const Time start{};
  Time now = start;
  Pacing pacing(length, speed, now);
  std::mt19937 random(7);
  Paced out;
  for (int i = 0; i < frames; ++i) {
    now = std::max(now, pacing.due());
    if (late.count() > 0) now += microseconds(random() % static_cast<unsigned>(late.count()));
    EXPECT_TRUE(pacing.is_due(now));
    now += work;
    pacing.count(now);
    if (i >= frames / 2) out.shown += pacing.reached() / (frames - frames / 2);
  }
  out.pace = frames * length / std::chrono::duration<double>(now - start).count();
  return out;
}

// A frame that comes late is followed by a short one. The mean of the paces of single frames would be 1.2
// here.
TEST(ViewPacing, IsOneWhereThreadsWakeLate) {
  const Paced paced = run(1, microseconds(500), microseconds(12'000), 2000);
  EXPECT_NEAR(paced.pace, 1, 1e-3);
  EXPECT_NEAR(paced.shown, 1, 1e-2);
}

TEST(ViewPacing, FollowsTheSpeed) {
  for (const double speed : {0.1, 0.5, 1.0}) {
    const Paced paced = run(speed, microseconds(100), microseconds(0), 300);
    EXPECT_NEAR(paced.pace, speed, 1e-3 * speed);
    EXPECT_NEAR(paced.shown, speed, 1e-3 * speed);
  }
}

TEST(ViewPacing, ShowsWhatSlowStepsLeave) {
  const Paced paced = run(1, microseconds(50'000), microseconds(0), 300);
  EXPECT_NEAR(paced.pace, 1 / 3.0, 1e-3);
  EXPECT_NEAR(paced.shown, 1 / 3.0, 1e-3);
}

TEST(ViewPacing, DoesNotHurryAfterAStall) {
  Time now{};
  Pacing pacing(1.0 / 60, 1, now);
  pacing.count(pacing.due());
  now = pacing.due() + std::chrono::seconds(10);
  pacing.count(now);
  int at_once = 0;
  for (; pacing.is_due(now); pacing.count(now)) ++at_once;
  EXPECT_LE(at_once, 2);
  pacing.start(now);
  EXPECT_EQ(pacing.reached(), 0);
  EXPECT_FALSE(pacing.is_due(now));
}

}  // namespace
}  // namespace plumb::view::PLUMB_TEST_FILE
