// What steps of some substeps take is learnt from what they took, and more or fewer are taken by that.

#include "time/substep_costs.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <functional>

namespace plumb::detail::PLUMB_TEST_FILE {
namespace {

constexpr std::uint32_t asked = 8;
constexpr double guess = 1;

/// Steps so often, with what so many substeps take (us). Returns how many were taken in all, and sets the
/// last.
std::uint64_t run(SubstepCosts& costs, int steps, double budget,
                  const std::function<double(std::uint32_t)>& cost, std::uint32_t* last = nullptr) {
  std::uint64_t sum = 0;
  for (int i = 0; i < steps; ++i) {
    const std::uint32_t taken = costs.fit(asked, budget, guess);
    costs.took(taken, cost(taken), false);
    sum += taken;
    if (last) *last = taken;
  }
  return sum;
}

double proportional(std::uint32_t substeps) {
  return 100.0 * substeps;
}

// Cuts or sweeps are then the same with any number.
double flat(std::uint32_t) {
  return 3000;
}

double dearer(std::uint32_t substeps) {
  return 3000 + 4000 / substeps;
}

TEST(SubstepCosts, FitWhatGrowsWithSubsteps) {
  SubstepCosts costs;
  std::uint32_t last = 0;
  run(costs, 12, 350, proportional, &last);
  EXPECT_EQ(last, 3u);
  EXPECT_NEAR(costs.relative(3), 3.0 / asked, 1e-12);
  // What suffices for all gets all, whatever was so before.
  run(costs, 12, 900, proportional, &last);
  EXPECT_EQ(last, asked);
}

// Above the budget anyway, they are as many as asked, and a few trials find that.
TEST(SubstepCosts, AreNotSavedWhereFewerAreNotCheaper) {
  for (const auto& cost : {flat, dearer}) {
    SubstepCosts costs;
    run(costs, 200, 1000, cost);
    EXPECT_GT(run(costs, 200, 1000, cost), 195u * asked);
  }
}

// One who believed that nothing grows finds out that it does, since scenes change.
TEST(SubstepCosts, AreSavedAgainWhereThatBecomesWorthIt) {
  SubstepCosts costs;
  run(costs, 400, 1000, flat);
  const auto dear = [](std::uint32_t substeps) { return 10 * proportional(substeps); };
  run(costs, 1100, 1000, dear);
  EXPECT_LE(run(costs, 100, 1000, dear), 105u);
}

// A time that cannot be kept even by one substep is missed by more in trials, so they become rare.
TEST(SubstepCosts, AreHardlyTriedInVain) {
  SubstepCosts costs;
  const int steps = 1000;
  run(costs, 10, 50, proportional);
  EXPECT_LE(run(costs, steps, 50, proportional), steps + 6u);
}

// What was cut short seems cheap, and is not.
TEST(SubstepCosts, AreNotLearntFromWhatWasCutShort) {
  SubstepCosts costs;
  for (int i = 0; i < 10; ++i) {
    costs.fit(asked, 1, guess);
    const std::uint32_t taken = i % 2 == 0 ? 1 : asked;
    costs.took(taken, std::min(proportional(taken), 120.0), taken == asked);
  }
  EXPECT_DOUBLE_EQ(costs.relative(1), 1.0 / asked);
}

// One step that is long because the machine did something else changes the next ones little.
TEST(SubstepCosts, ForgiveOneLongStep) {
  SubstepCosts costs;
  std::uint32_t last = 0;
  run(costs, 12, 350, proportional, &last);
  costs.fit(asked, 350, guess);
  costs.took(last, 1e5, false);
  run(costs, 1, 350, proportional, &last);
  EXPECT_EQ(last, 3u);
}

}  // namespace
}  // namespace plumb::detail::PLUMB_TEST_FILE
