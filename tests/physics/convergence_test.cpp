// Against truth: the order of every gradient point, on chains short enough that sweeps converge to 1e-12.

#include <gtest/gtest.h>

#include <cmath>
#include <string>
#include <vector>

#include "plumb/plumb.hpp"
#include "scenes/files/trajectory.hpp"
#include "scenes/generators/generators.hpp"
#include "support/planar_chain.hpp"
#include "support/worlds.hpp"

namespace plumb::PLUMB_TEST_FILE {
namespace {

using test::PlanarChain;

/// A chain of `n` links of 0.1 m, let go horizontally.
template <std::size_t n>
PlanarChain<n> planar_chain(double end_mass) {
  typename PlanarChain<n>::Vector masses;
  masses.fill(1);
  masses[n - 1] = end_mass;
  return PlanarChain<n>(masses, 0.1L, 9.81L);
}

template <std::size_t n>
Frame truth_after_a_second(double end_mass, int steps = 20000) {
  PlanarChain<n> chain = planar_chain<n>(end_mass);
  chain.advance(1, steps);
  return chain.frame();
}

std::string data(const char* file) {
  return std::string(PLUMB_TEST_DATA) + "/" + file;
}

// The truth itself: half the step changes it by less than what it is used for, and it agrees with a reference
// made by another method (files accurate to 1e-9) at every time that has one.
TEST(Truth, OfPlanarChainsHasConverged) {
  EXPECT_LE(rms_distance(truth_after_a_second<2>(1).positions, truth_after_a_second<2>(1, 40000).positions),
            1e-12);
  EXPECT_LE(rms_distance(truth_after_a_second<5>(10).positions, truth_after_a_second<5>(10, 40000).positions),
            1e-11);
  EXPECT_LE(
      rms_distance(truth_after_a_second<5>(10).velocities, truth_after_a_second<5>(10, 40000).velocities),
      1e-9);
}

TEST(Truth, OfPlanarChainsAgreesWithTheReference) {
  const std::vector<Frame> reference = scenes::read_trajectory(data("chain_N5_r10.csv"));
  ASSERT_EQ(reference.size(), 4u);
  PlanarChain<5> chain = planar_chain<5>(10);
  double t = 0;
  for (const Frame& wanted : reference) {
    chain.advance(static_cast<long double>(wanted.t) - t, 10000);
    t = wanted.t;
    EXPECT_LE(rms_distance(chain.frame().positions, wanted.positions), 1e-9) << "t = " << t;
    EXPECT_LE(rms_distance(chain.frame().velocities, wanted.velocities), 1e-7) << "t = " << t;
  }
}

struct Errors {
  double position = 0;  ///< m, RMS over particles
  double velocity = 0;  ///< m/s
};

Errors errors_after_a_second(const Scene& scene, const Frame& truth, Gradient gradient,
                             std::uint32_t substeps, SweepOrder order = SweepOrder::gauss_seidel) {
  World world(scene, {.method = Method::relax,
                      .gradient = gradient,
                      .order = order,
                      .substeps = substeps,
                      .stop = {.sweeps = 20000, .tolerance = 1e-12},
                      .threads = 1});
  const StepReport report = test::run(world, 1.0 / 60, 60);
  EXPECT_EQ(report.stopped_by, StoppedBy::tolerance) << "not converged: says nothing about order";
  EXPECT_EQ(report.mid_guarded, 0u);
  return {rms_distance(test::positions_of(world), truth.positions),
          rms_distance(test::velocities_of(world), truth.velocities)};
}

/// Orders from the last halving of the step, for positions and velocities.
void expect_order(const Scene& scene, const Frame& truth, Gradient gradient, std::uint32_t substeps,
                  double order, double tolerance = 0.15) {
  const Errors coarse = errors_after_a_second(scene, truth, gradient, substeps);
  const Errors fine = errors_after_a_second(scene, truth, gradient, 2 * substeps);
  EXPECT_NEAR(std::log2(coarse.position / fine.position), order, tolerance);
  EXPECT_NEAR(std::log2(coarse.velocity / fine.velocity), order, tolerance);
}

// The thesis's projection looks only at where rods end up: first order. It is still far from its limit at
// coarse steps (an order of 0.8 at 1/1,000 s), hence the finer ones.
TEST(Order, OfGradientNewIsOne) {
  expect_order(scenes::make_chain(1), truth_after_a_second<1>(1), Gradient::new_, 128, 1);
  expect_order(scenes::make_chain(2), truth_after_a_second<2>(1), Gradient::new_, 128, 1);
  expect_order(scenes::make_chain(3), truth_after_a_second<3>(1), Gradient::new_, 128, 1);
}

TEST(Order, OfGradientOldIsTwo) {
  expect_order(scenes::make_chain(1), truth_after_a_second<1>(1), Gradient::old, 16, 2);
  expect_order(scenes::make_chain(2), truth_after_a_second<2>(1), Gradient::old, 16, 2);
  expect_order(scenes::make_chain(3), truth_after_a_second<3>(1), Gradient::old, 16, 2);
}

TEST(Order, OfGradientMidIsTwo) {
  expect_order(scenes::make_chain(1), truth_after_a_second<1>(1), Gradient::mid, 16, 2);
  expect_order(scenes::make_chain(2), truth_after_a_second<2>(1), Gradient::mid, 16, 2);
  expect_order(scenes::make_chain(3), truth_after_a_second<3>(1), Gradient::mid, 16, 2);
}

// Five links with ten times the mass at the end: hundreds of sweeps to converge.
TEST(Order, HoldsWithAHeavyEnd) {
  const Scene scene = scenes::make_chain(5, 0.1, 10);
  const Frame truth = truth_after_a_second<5>(10);
  expect_order(scene, truth, Gradient::old, 8, 2);
  expect_order(scene, truth, Gradient::mid, 8, 2);
}

// In space, with masses 1 and 20, against a reference accurate to 1e-9.
TEST(Order, HoldsForADoublePendulumInSpace) {
  Scene scene;
  scene.particles = {test::fixed({0, 0, 0}), test::movable({0.7, 0.1, 0}, 1),
                     test::movable({1.1, -0.3, 0.2}, 20)};
  scene.rods = {{.a = 0, .b = 1}, {.a = 1, .b = 2}};
  const Frame truth = scenes::read_trajectory(data("double.csv")).back();
  ASSERT_EQ(truth.t, 1);
  for (const Gradient gradient : {Gradient::old, Gradient::mid}) expect_order(scene, truth, gradient, 16, 2);
}

// Jacobi sweeps are another way to the same point: at the same step and tolerance, the same error to three
// digits.
TEST(Order, IsThatOfTheStepNotOfTheSweeps) {
  const Scene scene = scenes::make_chain(3);
  const Frame truth = truth_after_a_second<3>(1);
  for (const Gradient gradient : {Gradient::new_, Gradient::old}) {
    const Errors by_color = errors_after_a_second(scene, truth, gradient, 16);
    const Errors at_once = errors_after_a_second(scene, truth, gradient, 16, SweepOrder::jacobi);
    EXPECT_NEAR(at_once.position / by_color.position, 1, 1e-3) << to_string(gradient);
  }
}

}  // namespace
}  // namespace plumb::PLUMB_TEST_FILE
