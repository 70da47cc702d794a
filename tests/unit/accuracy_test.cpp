// How an accuracy chooses substeps: what is compared, and what it makes of it.

#include "time/accuracy.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <vector>

namespace plumb::detail::PLUMB_TEST_FILE {
namespace {

TEST(Windows, CountWhatTheyCompare) {
  for (std::uint32_t count = 1; count <= 20; ++count)
    for (const bool starts_anew : {false, true}) {
      const Windows windows{.count = count, .length = 2, .starts_anew = starts_anew};
      std::uint32_t compared = 0;
      for (std::uint32_t k = 0; k < count; ++k) compared += windows.is_compared(k);
      EXPECT_EQ(windows.compared(), compared) << count;
      EXPECT_TRUE(windows.is_compared(count - 1));
      EXPECT_EQ(windows.is_compared(0), starts_anew || count % 2 == 1) << count;
    }
}

/// Moves x by h, wrong by c h^(order + 1) a substep, as a method of that order does.
struct Drifting {
  double c;
  std::uint32_t order;
  double x = 0, kept = 0, came_to = 0;
  std::uint32_t substeps = 0;

  AccuracyControl::Attempt compare(const AccuracyControl& control, double h, std::uint32_t count) {
    Tally counters;
    return control.compare(h, count, true, *this, counters);
  }
  void advance(double length, std::uint32_t n, Tally& counted) {
    x += n * (length + c * std::pow(length, order + 1));
    counted.direct_substeps += n;
    substeps += n;
  }
  void keep() { kept = x; }
  void take_back() {
    came_to = x;
    x = kept;
  }
  double distance() const { return std::abs(x - came_to); }
};

TEST(AccuracyControl, EstimatesTheErrorOfASubstepFromTwoLengths) {
  for (const std::uint32_t order : {1u, 2u, 4u, 6u}) {
    const AccuracyControl control{
        .allowed = 1, .least = 1, .most = 1000, .order = order, .by_comparison = true};
    Drifting drifting{.c = 0.3, .order = order};
    const double h = 0.05;
    const auto attempt = drifting.compare(control, h, 16);
    EXPECT_NEAR(attempt.error, 0.3 * std::pow(h, order + 1), 1e-14) << order;
    EXPECT_FALSE(attempt.is_blind || attempt.is_final);
    // Five of eight pairs (the first, and every other up to the last) also as one substep; all of a
    // first-order step by half as many.
    EXPECT_EQ(drifting.substeps, order == 1 ? 16u + 8u : 16u + 5u);
  }
}

TEST(AccuracyControl, FindsTheSubstepsThatAnAccuracyTakes) {
  const AccuracyControl control{
      .allowed = 1e-6, .least = 1, .most = 100'000, .order = 4, .by_comparison = true};
  Drifting drifting{.c = 1, .order = 4};
  double substep = 0;
  std::uint64_t last = 0;
  for (int step = 0; step < 10; ++step) {
    Tally counters;
    control.step(
        1, substep, counters,
        [&](double h, std::uint32_t count, Tally& of_attempt) {
          of_attempt.substeps += count;
          return drifting.compare(control, h, count);
        },
        [] {});
    EXPECT_EQ(counters.inaccurate_steps, 0u);
    last = counters.substeps;
  }
  // c h^4 = 1e-6 m/s at h = 1/31.6 s; a share of 0.7 of that is aimed at.
  EXPECT_GE(last, 32u);
  EXPECT_LE(last, 36u);
}

TEST(AccuracyControl, TakesAllBackOnceTheWorkIsSpent) {
  const AccuracyControl control{
      .allowed = 1e-12, .least = 1, .most = 100'000, .order = 2, .by_comparison = true};
  Drifting drifting{.c = 1, .order = 2};
  double substep = 0;
  Tally counters;
  counters.most_work = 500;
  int taken_back = 0, attempts = 0;
  const bool done = control.step(
      1, substep, counters,
      [&](double h, std::uint32_t count, Tally& of_attempt) {
        ++attempts;
        return control.compare(h, count, true, drifting, of_attempt);
      },
      [&] { ++taken_back; });
  EXPECT_FALSE(done);
  EXPECT_EQ(taken_back, attempts);
  EXPECT_EQ(counters.inaccurate_steps, 1u);
  EXPECT_GE(counters.work(), 500u);
  EXPECT_LE(counters.work(), 500u + 4u);
}

}  // namespace
}  // namespace plumb::detail::PLUMB_TEST_FILE
