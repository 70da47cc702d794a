// What a particle without rods does in one substep, against the exact solution of v' = a - c v.

#include "time/verlet.hpp"

#include <gtest/gtest.h>

#include <cmath>

namespace plumb::detail::PLUMB_TEST_FILE {
namespace {

constexpr Vec3 v0{1, -2, 3}, a{0.5, -9.81, 0.25};
constexpr Gradient all_gradients[] = {Gradient::new_, Gradient::old, Gradient::mid};

void expect_near(Vec3 got, Vec3 wanted, double tolerance) {
  EXPECT_LE(norm(got - wanted), tolerance) << "(" << got.x << ", " << got.y << ", " << got.z << ")";
}

/// Moved from the start by one substep, as the kernels predict.
Vec3 first_move(const Verlet& verlet, double h) {
  return verlet.decay(h) * verlet.start(v0, a, h).last + verlet.kick(a, h);
}

TEST(Verlet, FirstSubstepIsExactWithoutDrag) {
  for (const Gradient gradient : all_gradients)
    for (const double h : {1e-4, 0.02, 0.5})
      expect_near(first_move({gradient, 0}, h), h * v0 + (0.5 * h * h) * a, 1e-15);
}

// x = v/c (1 - e^-ch) + a/c (h - (1 - e^-ch)/c); 1e-10: the small c h of the closed form cancels.
TEST(Verlet, FirstSubstepIsExactWithDrag) {
  for (const double drag : {0.1, 3.0, 40.0}) {
    const double h = 0.02, gone = (1 - std::exp(-drag * h)) / drag;
    expect_near(first_move({Gradient::new_, drag}, h), gone * v0 + ((h - gone) / drag) * a, 1e-10);
  }
}

TEST(Verlet, HugeDragStaysFinite) {
  for (const Gradient gradient : all_gradients) {
    const Verlet verlet{gradient, 1e9};
    const auto start = verlet.start(v0, a, 1);
    EXPECT_TRUE(is_finite(start.last) && is_finite(start.before));
    EXPECT_TRUE(std::isfinite(verlet.decay(1)));
    EXPECT_TRUE(is_finite(verlet.kick(a, 1)));
  }
}

// Mean velocities of free flight at -h/2 and -3h/2 are extrapolated to exactly v0.
TEST(Verlet, StartHoldsTheVelocity) {
  const double h = 0.02;
  for (const Gradient gradient : all_gradients) {
    const Verlet verlet{gradient, 0};
    auto start = verlet.start(v0, a, h);
    expect_near(verlet.velocity(start, h), v0, 1e-13);
  }
}

TEST(Verlet, VelocityIsExactInFreeFlight) {
  const double h = 0.02;
  const Verlet verlet{Gradient::new_, 0};
  const auto mean = [&](double t) { return h * (v0 + t * a); };
  expect_near(verlet.velocity({mean(-h / 2), mean(-3 * h / 2)}, h), v0, 1e-13);
}

TEST(Verlet, ChangedStepsKeepFreeFlight) {
  const double h = 0.02, next = 0.05;
  for (const Gradient gradient : all_gradients) {
    const Verlet verlet{gradient, 0};
    const Vec3 last = verlet.start(v0, a, h).last;
    expect_near(verlet.change_step(last, a, h, next), verlet.start(v0, a, next).last, 1e-15);
  }
}

TEST(Verlet, ChangedForcesKeepTheVelocity) {
  const double h = 0.02;
  const Vec3 more{-3, 5, 100};
  for (const Gradient gradient : all_gradients) {
    const Verlet verlet{gradient, 0};
    const auto changed = verlet.change_acceleration(verlet.start(v0, a, h), (h * h) * more);
    expect_near(verlet.velocity(changed, h), v0, 1e-12);
    expect_near(changed.last, verlet.start(v0, a + more, h).last, 1e-15);
  }
}

}  // namespace
}  // namespace plumb::detail::PLUMB_TEST_FILE
