// Method multipliers: what keeps rods from drifting, loops, and rods that are redundant.

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "scenes/generators/generators.hpp"
#include "support/direct.hpp"
#include "support/exact_methods.hpp"
#include "support/random_trees.hpp"
#include "support/truths.hpp"
#include "truth/truth.hpp"

namespace plumb::PLUMB_TEST_FILE {
namespace {

using test::multipliers;

double stretch_after(const Scene& scene, const Settings& settings, double dt, int steps) {
  World world(scene, settings);
  test::run(world, dt, steps);
  return test::stretch_of(scene, world).max;
}

// Keeping second derivatives at zero keeps lengths only as well as the integrator does: the error grows with
// time. Feedback holds it where it is made as fast as it decays; projection leaves rounding.
TEST(Multipliers, DriftUnlessStabilized) {
  Scene scene = scenes::make_chain(5);
  for (std::uint32_t i = 1; i <= 5; ++i)
    scene.particles[i].position = {0.1 * i * std::sin(0.5), -0.1 * i * std::cos(0.5), 0};
  struct Worst {
    double first = 0, last = 0;  // in the first second, in the eighth
  };
  const auto strain = [&](Stabilization stabilization) {
    World world(scene, multipliers(stabilization, Integrator::semi_implicit_euler));
    Worst worst;
    for (int i = 0; i < 8000; ++i) {
      world.step(1e-3);
      double& most = i < 1000 ? worst.first : worst.last;
      if (i < 1000 || i >= 7000) most = std::max(most, test::stretch_of(scene, world).max);
    }
    return worst;
  };
  const Worst none = strain(Stabilization::none), baumgarte = strain(Stabilization::baumgarte),
              projection = strain(Stabilization::projection);
  EXPECT_NEAR(none.last / none.first, 8, 2) << "as much in every second";
  EXPECT_GT(none.last, 0.02);
  EXPECT_LE(baumgarte.last, 1.5 * baumgarte.first);
  EXPECT_LE(baumgarte.last, 0.1 * none.last);
  EXPECT_LE(projection.last, 1e-14);
}

// C = (|d|² - L²)/2 of a rod that starts too long decays as (1 + alpha t) exp(-alpha t), whatever the motion:
// critically damped (Baumgarte 1972), from rest.
TEST(Multipliers, FeedbackDecaysAtItsRate) {
  Scene scene = test::double_pendulum();
  const Vec3 d = scene.particles[2].position - scene.particles[1].position;
  scene.rods[0].length = norm(scene.particles[1].position);
  scene.rods[1].length = 0.9 * norm(d);
  const auto off = [&](Vec3 e) { return 0.5 * (dot(e, e) - std::pow(scene.rods[1].length, 2)); };
  const double at_first = off(d);
  for (const double rate : {5.0, 20.0}) {
    Settings settings = multipliers(Stabilization::baumgarte, Integrator::rk4, 10);
    settings.multipliers.baumgarte_rate = rate;
    World world(scene, settings);
    for (const int i : {1, 2, 3}) {
      test::run(world, 0.01, 10);
      const double x = rate * 0.1 * i;
      // RK4 at 1 ms: an error of order (rate h)^4.
      EXPECT_NEAR(off(world.position(2) - world.position(1)) / at_first, (1 + x) * std::exp(-x), 1e-6)
          << rate << " at " << 0.1 * i;
    }
  }
}

// Rods that start off their length are put on it by the first projection.
TEST(Multipliers, ProjectionPutsRodsOnTheirLength) {
  Scene scene = scenes::make_tree();
  for (std::size_t i = 0; i < scene.rods.size(); ++i) scene.rods[i].length = 1.02 * rod_length(scene, i);
  EXPECT_LE(stretch_after(scene, multipliers(Stabilization::projection), 1e-3, 1), 1e-14);
  EXPECT_GE(stretch_after(scene, multipliers(Stabilization::none), 1e-3, 1), 1.9e-2);
}

// The projection moves particles in proportion to their inverse mass, so a body in free flight keeps its
// centre of mass.
TEST(Multipliers, ProjectionKeepsTheCentreOfMass) {
  test::Random random(9);
  Scene scene = test::random_tree(random, {.movable = 12, .anchors = 0, .masses = 10, .rod_mass = 2});
  scene.gravity = {};
  for (std::size_t i = 0; i < scene.rods.size(); ++i) scene.rods[i].length = 1.01 * rod_length(scene, i);
  World world(scene, multipliers(Stabilization::projection));
  world.step(1e-3);
  const auto center = [&](const std::vector<Vec3>& x) {
    return measure_momentum(scene, x, x, MassModel::consistent).center_of_mass;
  };
  std::vector<Vec3> before;
  for (const Particle& particle : scene.particles) before.push_back(particle.position);
  EXPECT_GT(rms_distance(test::positions_of(world), before), 1e-3);
  EXPECT_LE(norm(center(test::positions_of(world)) - center(before)), 1e-13);
}

void expect_true(const Scene& scene, MassModel mass, const char* what) {
  const truth::Truth truth = truth::solve(scene, {.save_at = {0.3}, .mass = mass});
  World world(scene, test::exact(Method::multipliers, Integrator::rk4, 40, mass));
  test::run(world, 0.01, 30);
  const test::Apart off = test::apart(test::frame_of(world), truth.frames.front());
  EXPECT_LE(off.position, 1e-8) << what << ", " << to_string(mass);
  EXPECT_LE(off.velocity, 1e-7) << what << ", " << to_string(mass);
  EXPECT_LE(test::stretch_of(scene, world).max, 1e-12) << what << ", " << to_string(mass);
}

// Loops, in either model of mass; the box has ten rods more than it needs.
TEST(Multipliers, MoveLoopsAsTheTruthDoes) {
  for (const MassModel mass : {MassModel::consistent, MassModel::lumped}) {
    expect_true(test::hung_ring(1), mass, "ring");
    expect_true(test::braced_box(1), mass, "box");
    expect_true(scenes::make_truss({.bays = 4, .chords = 3, .braces = 2, .fixed = 2}), mass, "truss");
  }
}

// Trees between several fixed particles: through two, straight at a tie, held by three.
TEST(Multipliers, MoveTreesWithSeveralTiesAsTheTruthDoes) {
  Scene arch;
  arch.particles = {test::anchor({0, 0, 0}),         test::loose({0.3, 0, 0}, 1),
                    test::loose({0.6, 0, 0}, 0.5),   test::loose({0.8, -0.3, 0.1}, 2),
                    test::anchor({1, 0, 0}),         test::loose({0.6, -0.3, 0}, 1),
                    test::loose({0.9, -0.6, 0.2}, 3)};
  arch.rods = {{.a = 0, .b = 1}, {.a = 1, .b = 2, .mass = 1}, {.a = 3, .b = 2}, {.a = 3, .b = 4},
               {.a = 2, .b = 5}, {.a = 3, .b = 6, .mass = 2}};
  expect_true(arch, MassModel::consistent, "two ties, two rods straight behind one");
  std::swap(arch.rods[0], arch.rods[3]);  // rooted at the other end
  expect_true(arch, MassModel::consistent, "two ties, two rods straight before one");

  Scene held;
  held.particles = {test::anchor({0, 0, 0}),          test::anchor({1, 0, 0}),
                    test::anchor({0, 0, 1}),          test::anchor({1, 1, 1}),
                    test::loose({0.5, -0.5, 0.5}, 1), test::loose({1, -0.7, 0.5}, 2),
                    test::loose({1.2, -0.7, 0.9}, 1)};
  held.rods = {{.a = 0, .b = 4}, {.a = 1, .b = 4}, {.a = 2, .b = 4},
               {.a = 3, .b = 4}, {.a = 4, .b = 5}, {.a = 5, .b = 6, .mass = 1}};
  expect_true(held, MassModel::consistent, "a particle that four rods hold for good");
  expect_true(held, MassModel::lumped, "a particle that four rods hold for good");

  test::Random random(21);
  for (int round = 0; round < 4; ++round) {
    const Scene scene = test::random_tree(
        random,
        {.movable = 10, .anchors = 4, .ties = 1, .masses = 3, .rod_mass = round % 2 == 0 ? 0.0 : 1.0});
    expect_true(scene, MassModel::consistent, "random tree");
  }
}

// A loop cut open by an anchor is a tree of its own: the factorisations for trees and for any graph agree.
TEST(Multipliers, SolveTreesAndLoopsAlike) {
  test::Random random(4);
  Scene scene = test::random_tree(random, {.movable = 12, .anchors = 1, .masses = 3, .rod_mass = 1});
  // A triangle that the tree does not feel: its rods join at one particle and lie there without mass of note.
  Scene looped = scene;
  const auto corner = static_cast<std::uint32_t>(scene.particles.size());
  const auto at = static_cast<std::uint32_t>(scene.particles[0].fixed ? 1 : 0);
  const Vec3 x = scene.particles[at].position;
  for (const Vec3 way : {Vec3{0.1, 0, 0}, Vec3{0, 0.1, 0}})
    looped.particles.push_back(test::loose(x + way, 1e-9));
  looped.rods.push_back({.a = at, .b = corner});
  looped.rods.push_back({.a = corner, .b = corner + 1});
  looped.rods.push_back({.a = at, .b = corner + 1});
  World tree(scene, multipliers(Stabilization::projection, Integrator::rk4, 20)),
      loop(looped, multipliers(Stabilization::projection, Integrator::rk4, 20));
  test::run(tree, 0.01, 20);
  test::run(loop, 0.01, 20);
  for (std::uint32_t i = 0; i < corner; ++i)
    EXPECT_LE(norm(tree.position(i) - loop.position(i)), 1e-7)
        << i;  // by the share of its mass, and its lever
}

}  // namespace
}  // namespace plumb::PLUMB_TEST_FILE
