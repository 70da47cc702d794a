// Mass along rods: with the consistent mass matrix they swing as the bodies they are.

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <string>
#include <vector>

#include "scenes/files/trajectory.hpp"
#include "scenes/generators/generators.hpp"
#include "support/direct.hpp"
#include "support/truths.hpp"
#include "truth/truth.hpp"

namespace plumb::PLUMB_TEST_FILE {
namespace {

constexpr double g = 9.81;

double error_after_a_second(MassModel mass, std::uint32_t substeps) {
  const Scene scene = scenes::make_rods5();
  const std::vector<Frame> frames = scenes::read_trajectory(PLUMB_TEST_DATA "/rods5.csv");
  const auto truth = std::find_if(frames.begin(), frames.end(), [](const Frame& f) { return f.t == 1; });
  World world(scene, test::direct(Gradient::mid, substeps, mass));
  test::run(world, 1.0 / 60, 60);
  return test::relative_error(scene, world, truth->positions);
}

// Half masses at the ends are another body: its error does not fall with the step.
TEST(DirectMass, ConsistentConvergesAndLumpedDoesNot) {
  EXPECT_LE(error_after_a_second(MassModel::consistent, 16), 1e-4);
  EXPECT_LE(error_after_a_second(MassModel::consistent, 64), 1e-5);
  for (const std::uint32_t substeps : {1u, 4u, 16u, 64u})
    EXPECT_GE(error_after_a_second(MassModel::lumped, substeps), 1e-2) << substeps;
}

/// s, of a body let go horizontally that swings as a point at `reach` (m): 2 pi sqrt(l/g) / agm(1, cos(a/2))
/// with a = 90 degrees (Gauss).
double period_of(double reach) {
  double a = 1, b = std::sqrt(0.5);
  for (int i = 0; i < 6; ++i) {
    const double mean = (a + b) / 2;
    b = std::sqrt(a * b);
    a = mean;
  }
  return 2 * std::numbers::pi * std::sqrt(reach / g) / a;
}

/// Second order: after one period in n steps, it is off by C/n^2.
void expect_swings_as(const Rod& rod, double reach, MassModel mass, const char* what) {
  Scene scene;
  scene.particles = {test::anchor({1, 2, 3}), test::loose({1.6, 2, 3})};
  scene.rods = {rod};
  for (const Gradient gradient : {Gradient::old, Gradient::mid}) {
    double off[2];
    for (const int n : {1000, 2000}) {
      World world(scene, test::direct(gradient, 1, mass));
      test::run(world, period_of(reach) / n, n);
      off[n / 1000 - 1] = norm(world.position(1) - scene.particles[1].position);
      EXPECT_LE(norm(world.velocity(1)), 1e-3) << what << ": at rest again";
    }
    // It comes to rest where it was let go; near there, position is quadratic in the error of time.
    EXPECT_LE(off[0], 1e-6) << what << ", gradient " << to_string(gradient);
    EXPECT_LE(off[1], 1e-7) << what << ", gradient " << to_string(gradient);
    World quarter(scene, test::direct(gradient, 1, mass));
    test::run(quarter, period_of(reach) / 4000, 1000);
    EXPECT_LE(norm(quarter.position(1) - Vec3{1, 1.4, 3}), 3e-6) << what << ": straight down";
  }
}

TEST(DirectMass, RodsHaveThePeriodOfTheirInertia) {
  expect_swings_as({.a = 0, .b = 1, .mass = 3}, 0.4, MassModel::consistent, "uniform: 2/3 of the length");
  expect_swings_as({.a = 1, .b = 0, .mass = 3}, 0.4, MassModel::consistent, "the other way round");
  expect_swings_as({.a = 0, .b = 1, .mass = 3}, 0.6, MassModel::lumped, "half masses");
  // (c^2 L^2 + I/m) / (c L) with the centre of mass at c L.
  const double c = 0.25, inertia = 0.05;
  expect_swings_as({.a = 0, .b = 1, .mass = 3, .center = c, .inertia = inertia},
                   0.6 * (c + inertia / (3 * 0.36) / c), MassModel::consistent, "uneven");
  expect_swings_as({.a = 1, .b = 0, .mass = 3, .center = 1 - c, .inertia = inertia},
                   0.6 * (c + inertia / (3 * 0.36) / c), MassModel::consistent,
                   "uneven, the other way round");
  expect_swings_as({.a = 0, .b = 1, .mass = 3, .center = c, .inertia = 0}, 0.6 * c, MassModel::consistent,
                   "all at a quarter");
}

// Three uniform rods in a row between two fixed points, and a tree of uneven ones: against the truth.
TEST(DirectMass, RodsBetweenTwoFixedPoints) {
  Scene scene;
  scene.particles = {test::anchor({0, 0, 0}), test::loose({0.3, 0.4, 0}), test::loose({0.7, 0.5, 0.1}),
                     test::anchor({1, 0, 0})};
  scene.rods = {{.a = 0, .b = 1, .mass = 1},
                {.a = 1, .b = 2, .mass = 2, .center = 0.7, .inertia = 0.02},
                {.a = 3, .b = 2, .mass = 1, .center = 0.2, .inertia = 0.01}};
  const Frame truth = truth::solve(scene, {.save_at = {0.5}}).frames.front();
  for (const Gradient gradient : {Gradient::old, Gradient::mid}) {
    double last = 0;
    for (const std::uint32_t substeps : {8u, 16u}) {
      World world(scene, test::direct(gradient, substeps));
      test::run(world, 1.0 / 60, 30);
      const double error = test::relative_error(scene, world, truth.positions);
      if (last > 0) {
        EXPECT_NEAR(last / error, 4, 0.3) << to_string(gradient);
      }
      last = error;
    }
    EXPECT_LE(last, 2e-4) << to_string(gradient);
  }
}

// Rods without mass have the same mass matrix in both models: to the bit.
TEST(DirectMass, ModelsAgreeToTheBitWithoutRodMass) {
  for (const Gradient gradient : {Gradient::new_, Gradient::old, Gradient::mid}) {
    const Scene scene = scenes::make_chain(20, 0.1, 10);
    World consistent(scene, test::direct(gradient, 2)),
        lumped(scene, test::direct(gradient, 2, MassModel::lumped));
    test::run(consistent, 1.0 / 60, 120);
    test::run(lumped, 1.0 / 60, 120);
    EXPECT_EQ(consistent.state_hash(), lumped.state_hash()) << to_string(gradient);
  }
}

}  // namespace
}  // namespace plumb::PLUMB_TEST_FILE
