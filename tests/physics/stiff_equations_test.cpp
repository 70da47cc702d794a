// The thesis's examples of stiff equations (3.3.2, 3.3.3) and of velocities (figure 3.12).
#include "thesis/stiff_equations.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

namespace plumb::tools::PLUMB_TEST_FILE {
namespace {

StiffState after(StiffState (*step)(StiffState, double, double), double k, double h, int steps) {
  StiffState state;
  for (int i = 0; i < steps; ++i) state = step(state, k, h);
  return state;
}

// Eq. 3.15: y_n = (1 - h k)^n. A thousand steps at a thousandth from h k = 2 make a factor e either way; the
// power of 1000 steps carries 1000 roundings.
TEST(StiffEquations, ExplicitStepsGrowBeyondTwo) {
  for (const double k : {1.0, 100.0, 1e6}) {
    for (const double hk : {0.5, 1.0, 1.999, 2.001, 2.5}) {
      const double y = std::abs(after(explicit_step, k, hk / k, 1000).y);
      const double predicted = std::pow(std::abs(1 - hk), 1000);
      EXPECT_NEAR(y, predicted, 1e-9 * predicted) << hk;
      EXPECT_EQ(y > 1, hk > 2) << hk;
    }
    EXPECT_NEAR(std::abs(after(explicit_step, k, 2 / k, 1000).y), 1, 1e-12);
  }
  // The mild direction sets no limit until h = 2: it is the stiff one that does.
  EXPECT_LT(std::abs(after(explicit_step, 100, 0.021, 1000).x), 1e-9);
  EXPECT_GT(std::abs(after(explicit_step, 100, 0.021, 1000).y), 1e40);
}

// Eq. 3.24 and 3.25, to rounding.
TEST(StiffEquations, ImplicitStepsComeToRest) {
  for (const double k : {1.0, 100.0, 1e6}) {
    for (const double hk : {0.5, 2.0, 1e3, 1e6}) {
      const StiffState state = implicit_step({}, k, hk / k);
      EXPECT_NEAR(state.x, 1 / (1 + hk / k), 1e-15);
      EXPECT_NEAR(state.y, 1 / (1 + hk), 1e-15);
    }
    const StiffState rest = implicit_step({3, -4}, k, std::numeric_limits<double>::infinity());
    EXPECT_EQ(rest.x, 0);
    EXPECT_EQ(rest.y, 0);
  }
}

// Both are first order: errors at t = 1 halve with the step. (1 - 1/n)^n = e^-1 (1 - 1/(2n) ...), and
// backward the same with the other sign; the next term is of relative size 1/n.
TEST(StiffEquations, BothAreFirstOrder) {
  const double exact = std::exp(-1.0);
  for (const int n : {100, 1000}) {
    EXPECT_NEAR((after(explicit_step, 1, 1.0 / n, n).y - exact) * 2 * n / exact, -1, 2.0 / n);
    EXPECT_NEAR((after(implicit_step, 1, 1.0 / n, n).y - exact) * 2 * n / exact, 1, 2.0 / n);
  }
}

// Figure 3.12: the velocity that Verlet's two last positions give is half a step old, an error of h/2 times
// the acceleration; the midpoint rule's is of second order. Verlet's positions are not to blame: the
// velocity between the neighbours of a position is more exact than the midpoint rule's, whose error in phase
// and size also grows with time.
TEST(VelocityEstimates, VerletIsLessExactThanRungeKutta) {
  const double period = 2 * std::acos(-1.0);
  for (const int n : {50, 100, 200}) {
    const double h = period / n;
    const double rk2 = velocity_error(VelocityScheme::rk2, h, period);
    const double backward = velocity_error(VelocityScheme::verlet_backward, h, period);
    const double central = velocity_error(VelocityScheme::verlet_central, h, period);
    EXPECT_NEAR(backward / (h / 2), 1, 0.1) << n;
    // The midpoint rule's phase is off by h²/6 every second, Verlet's by h²/24 and its velocity by h²/8.
    EXPECT_NEAR(rk2 / (h * h), period / 6, 0.01 * period / 6) << n;
    EXPECT_LT(central, rk2 / 3) << n;
    EXPECT_NEAR(backward / rk2, 3 / (h * period), 0.05 * 3 / (h * period)) << n;
  }
}

}  // namespace
}  // namespace plumb::tools::PLUMB_TEST_FILE
