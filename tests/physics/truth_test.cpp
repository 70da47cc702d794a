// Truths against solutions in closed form, other coordinates, and stored references.
#include "truth/truth.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <string>

#include "scenes/files/trajectory.hpp"
#include "scenes/generators/generators.hpp"
#include "support/planar_chain.hpp"
#include "support/series_order.hpp"
#include "support/truths.hpp"
#include "truth/integrators/integrator.hpp"

namespace plumb::truth::PLUMB_TEST_FILE {
namespace {

using test::apart;

/// Rounding of the double numbers in frames, masses and times, in m and m/s at sizes of about one.
constexpr double rounding = 2e-15;

Frame truth_at(const Scene& scene, double t, MassModel mass = MassModel::consistent) {
  return solve(scene, {.save_at = {t}, .mass = mass}).frames.front();
}

/// A point mass on a rod of `length`, horizontal at first.
Scene pendulum(double length) {
  Scene scene;
  scene.particles = {test::anchor({0, 0, 0}), test::loose({length, 0, 0}, 2)};
  scene.rods = {{.a = 0, .b = 1}};
  return scene;
}

// A pendulum let go at the angle a has the period 2 pi sqrt(L/g) / agm(1, cos(a/2)) (Gauss); a is 90 degrees.
TEST(TruthMotion, PendulumHasItsPeriod) {
  const long double length = 0.5L, gravity = 9.81;
  long double a = 1, b = std::sqrt(0.5L);
  for (int i = 0; i < 6; ++i) {
    const long double mean = (a + b) / 2;
    b = std::sqrt(a * b);
    a = mean;
  }
  const long double period = 2 * std::numbers::pi_v<long double> * std::sqrt(length / gravity) / a;
  const double quarter = static_cast<double>(period / 4), half = static_cast<double>(period / 2);
  const Truth truth =
      solve(pendulum(0.5), {.save_at = {quarter, half, static_cast<double>(period)}, .tolerance = 1e-14});
  const double fastest = static_cast<double>(std::sqrt(2 * gravity * length));
  EXPECT_LT(apart(truth.frames[0], {0, {{}, {0, -0.5, 0}}, {{}, {-fastest, 0, 0}}}).position, rounding);
  EXPECT_LT(apart(truth.frames[0], {0, {{}, {0, -0.5, 0}}, {{}, {-fastest, 0, 0}}}).velocity, rounding);
  EXPECT_LT(apart(truth.frames[1], {0, {{}, {-0.5, 0, 0}}, {{}, {}}}).position, rounding);
  EXPECT_LT(apart(truth.frames[1], {0, {{}, {-0.5, 0, 0}}, {{}, {}}}).velocity, rounding);
  EXPECT_LT(apart(truth.frames[2], {0, {{}, {0.5, 0, 0}}, {{}, {}}}).position, rounding);
}

// A body on an axis swings as a point at its inertia over its moment: a uniform rod as one at 2/3 of it.
TEST(TruthMotion, RodsSwingAsTheirInertiaSays) {
  const auto expect_swings_as = [](const Rod& rod, double share, MassModel mass) {
    Scene scene;
    scene.particles = {test::anchor({0, 0, 0}), test::loose({0.6, 0, 0})};
    scene.rods = {rod};
    const Frame is = truth_at(scene, 1.3, mass), point = truth_at(pendulum(0.6 * share), 1.3);
    EXPECT_LT(norm(share * is.positions[1] - point.positions[1]), rounding) << share;
    EXPECT_LT(norm(share * is.velocities[1] - point.velocities[1]), 4 * rounding) << share;
  };
  expect_swings_as({.a = 0, .b = 1, .mass = 3}, 2.0 / 3, MassModel::consistent);
  expect_swings_as({.a = 1, .b = 0, .mass = 3}, 2.0 / 3, MassModel::consistent);
  expect_swings_as({.a = 0, .b = 1, .mass = 3}, 1, MassModel::lumped);
  // Centre of mass at c L: (c² L² + I/m) / (c L), here in units of L.
  const double inertia = 0.05, c = 0.25, share = c + inertia / (3 * 0.36) / c;
  expect_swings_as({.a = 0, .b = 1, .mass = 3, .center = c, .inertia = inertia}, share,
                   MassModel::consistent);
}

// Angles have no constraints to keep; classical Runge-Kutta at this step is good to 1e-13.
TEST(TruthMotion, ChainIsThatOfItsAngles) {
  test::PlanarChain<3> chain({1, 1, 10}, 0.1L, 9.81);
  chain.advance(0.5L, 40000);
  const auto difference = apart(truth_at(scenes::make_chain(3, 0.1, 10), 0.5), chain.frame());
  EXPECT_LT(difference.position, 1e-12);
  EXPECT_LT(difference.velocity, 1e-11);
}

// Without rods: x = v/c (1 - exp(-ct)), and gravity g/c² (ct - 1 + exp(-ct)).
TEST(TruthMotion, DragIsExponential) {
  Scene scene;
  scene.particles = {test::loose({0, 0, 0}, 2)};
  scene.particles[0].velocity = {3, 0, 0};
  scene.drag = 0.7;
  const double t = 2, c = 0.7, left = std::exp(-c * t);
  const Frame frame = truth_at(scene, t);
  EXPECT_NEAR(frame.positions[0].x, 3 / c * (1 - left), rounding);
  EXPECT_NEAR(frame.velocities[0].x, 3 * left, rounding);
  EXPECT_NEAR(frame.positions[0].y, -9.81 / (c * c) * (c * t - 1 + left), 10 * rounding);
  EXPECT_NEAR(frame.velocities[0].y, -9.81 / c * (1 - left), 10 * rounding);
}

// A floating body of rods with mass under drag: both momenta decay as exp(-ct).
TEST(TruthMotion, DragLetsMomentaDecay) {
  Scene scene = scenes::make_tree();
  scene.particles[0] = test::loose({0, 0, 0}, 0.3);
  scene.particles[0].velocity = {1, 2, 3};
  scene.particles[5].velocity = {-2, 1, 1};
  scene.gravity = {};
  scene.drag = 0.7;
  const Truth truth = solve(scene, {.save_at = {0, 1.5}});
  const auto momentum = [&](const Frame& f) {
    return measure_momentum(scene, f.positions, f.velocities, MassModel::consistent);
  };
  const Momentum first = momentum(truth.frames[0]), last = momentum(truth.frames[1]);
  const double left = std::exp(-0.7 * 1.5);
  EXPECT_LT(norm(last.linear - left * first.linear), 10 * rounding);
  EXPECT_LT(norm(last.angular - left * first.angular), 10 * rounding);
}

TEST(TruthMotion, KeepsEnergy) {
  for (const Scene& scene : {test::double_pendulum(), scenes::make_rods5(), scenes::make_tree(),
                             test::hung_ring(1), test::braced_box(2), scenes::make_chain(20, 0.1, 1000)}) {
    EXPECT_LT(solve(scene, {.save_at = {0.2, 0.6}}).energy_drift, 1e-14) << scene.rods.size() << " rods";
  }
  EXPECT_LT(solve(test::hung_ring(1), {.save_at = {0.2, 0.6}, .mass = MassModel::lumped}).energy_drift,
            1e-14);
}

// Half the step, 2^order of the error.
TEST(TruthMotion, ConvergesWithTheOrderOfTheSeries) {
  const Model model = make_model(scenes::make_tree(), MassModel::consistent);
  const State start = start_of(scenes::make_tree(), model);
  for (const std::uint32_t order : {2u, 3u, 4u, 6u, 8u}) {
    EXPECT_NEAR(test::measured_order(model, start, order, 16), order, 0.2);
  }
}

// Ten rods too many change nothing: the box with just enough of them moves the same.
TEST(TruthMotion, RedundantRodsChangeNothing) {
  Scene scene = test::braced_box();
  scene.particles[5].velocity = {0.3, -0.2, 1};
  const Truth all = solve(scene, {.save_at = {0.5}});
  EXPECT_EQ(all.redundant, 10u);
  // The anchor's three neighbours in a triangle, and each other corner tied to them: none lies in their
  // plane.
  const auto neighbour = [](std::uint32_t i) { return i == 1 || i == 2 || i == 4; };
  std::erase_if(scene.rods, [&](const Rod& rod) { return !neighbour(rod.a) && !neighbour(rod.b); });
  ASSERT_EQ(scene.rods.size(), 18u);
  // Velocities are projected onto the same motions, so they too are the same.
  const Truth enough = solve(scene, {.save_at = {0.5}});
  EXPECT_EQ(enough.redundant, 0u);
  EXPECT_LT(apart(all.frames[0], enough.frames[0]).position, 10 * rounding);
  EXPECT_LT(apart(all.frames[0], enough.frames[0]).velocity, 10 * rounding);
}

void expect_agrees(const Scene& scene, const std::string& path) {
  const std::vector<Frame> stored = scenes::read_trajectory(path);
  Plan plan;
  for (const Frame& frame : stored) plan.save_at.push_back(frame.t);
  const Truth truth = solve(scene, plan);
  for (std::size_t i = 0; i < stored.size(); ++i) {
    const test::Apart difference = apart(truth.frames[i], stored[i]);
    EXPECT_LT(difference.position / truth.diagonal, 1e-9) << path << " at " << stored[i].t;
    EXPECT_LT(difference.velocity / truth.speed, 1e-9) << path << " at " << stored[i].t;
  }
}

// References from another program.
TEST(TruthMotion, AgreesWithReferences) {
  const std::string data = PLUMB_TEST_DATA "/";
  expect_agrees(scenes::make_chain(5, 0.1, 10), data + "chain_N5_r10.csv");
  expect_agrees(scenes::make_chain(20, 0.1, 10), data + "chain_N20_r10.csv");
  expect_agrees(test::double_pendulum(), data + "double.csv");
  expect_agrees(scenes::make_rods5(), data + "rods5.csv");
  expect_agrees(scenes::make_tree(), data + "tree.csv");
}

}  // namespace
}  // namespace plumb::truth::PLUMB_TEST_FILE
