// What method direct keeps with gradient mid: energy, and of what floats its momenta, whatever the step, to
// the rounding of double and the last Newton step (1e-7 of a rod, squared).

#include <gtest/gtest.h>

#include <cmath>

#include "scenes/generators/generators.hpp"
#include "support/direct.hpp"
#include "support/random_trees.hpp"
#include "support/sanitizers.hpp"
#include "support/truths.hpp"

namespace plumb::PLUMB_TEST_FILE {
namespace {

using test::Kept;

// Steps of a whole 1/60 s: chains whip, Newton fails and halves, and energy stays. 200 s for 5 links, 60 s
// for 20, 10 s for 100: what a test has time for.
TEST(DirectEnergy, IsKeptByChainsWhateverTheStep) {
  for (const std::uint32_t links : {5u, 20u, 100u})
    for (const double end_mass : {1.0, 100.0, 1000.0}) {
      const Scene scene = scenes::make_chain(links, 0.1, end_mass);
      World world(scene, test::direct(Gradient::mid));
      const int steps = links == 5 ? 12000 : links == 20 ? 3600 : 600;
      const Kept kept = test::run_and_watch(scene, world, test::scaled(steps));
      EXPECT_LE(kept.drift, 1e-9) << links << ", " << end_mass;
      EXPECT_LE(kept.strain, 1e-9) << links << ", " << end_mass;
      EXPECT_EQ(kept.report.unsolved, 0u);
      EXPECT_EQ(kept.report.fallbacks, 0u);
    }
}

TEST(DirectEnergy, IsKeptByRodsWithMass) {
  for (const std::uint32_t links : {5u, 20u, 100u}) {
    Scene scene = scenes::make_chain(links);
    for (Particle& particle : scene.particles) particle.mass = 0;
    for (Rod& rod : scene.rods) rod.mass = 1;
    World world(scene, test::direct(Gradient::mid));
    const Kept kept = test::run_and_watch(scene, world, test::scaled(links == 100 ? 120 : 600));
    EXPECT_LE(kept.drift, 1e-9) << links;
    EXPECT_LE(kept.strain, 1e-9) << links;
    EXPECT_EQ(kept.report.unsolved, 0u);
  }
}

// In the lanes of a vector as well, where a tree that fails is halved by itself.
TEST(DirectEnergy, IsKeptSideBySide) {
  const Scene scene = scenes::make_ensemble({.chains = 10, .links = 5, .end_mass = 100, .vary = 0.5});
  World world(scene, test::direct(Gradient::mid));
  const Kept kept = test::run_and_watch(scene, world, test::scaled(300));
  EXPECT_LE(kept.drift, 1e-9);
  EXPECT_LE(kept.strain, 1e-9);
  EXPECT_EQ(kept.report.unsolved, 0u);
}

// Branches held by several fixed points, with mass on some rods.
TEST(DirectEnergy, IsKeptByBranchesBetweenFixedPoints) {
  test::Random random(21);
  for (int round = 0; round < 8; ++round) {
    const Scene scene = test::random_tree(
        random,
        {.movable = 12, .anchors = 3, .ties = 1, .masses = 5, .rod_mass = round % 2 == 0 ? 0.0 : 2.0});
    World world(scene, test::direct(Gradient::mid, 4));
    const Kept kept = test::run_and_watch(scene, world, test::scaled(240));
    EXPECT_LE(kept.drift, 1e-9) << round;
    EXPECT_LE(kept.strain, 1e-9) << round;
    EXPECT_EQ(kept.report.unsolved, 0u) << round;
  }
}

// A floating body of rods with mass, thrown and turning.
TEST(DirectMomentum, OfAFreeTreeIsKept) {
  Scene scene = scenes::make_tree();
  scene.particles[0] = test::loose({0, 0, 0}, 0.3);
  scene.particles[0].velocity = {1, 2, 3};
  scene.particles[4].velocity = {0, -3, 1};
  scene.particles[5].velocity = {-2, 1, 1};
  scene.gravity = {};
  for (const Gradient gradient : {Gradient::mid, Gradient::old, Gradient::new_}) {
    World world(scene, test::direct(gradient, 4));
    const auto momentum = [&] {
      return measure_momentum(scene, test::positions_of(world), test::velocities_of(world),
                              MassModel::consistent);
    };
    double mass = 0;
    for (const Particle& particle : scene.particles) mass += particle.mass;
    for (const Rod& rod : scene.rods) mass += rod.mass;
    const Momentum before = momentum();
    const double energy = test::energy_of(scene, world, MassModel::consistent);
    test::run(world, 1.0 / 60, 300);
    const Momentum after = momentum();
    EXPECT_LE(norm(after.linear - before.linear), 1e-11 * norm(before.linear)) << to_string(gradient);
    if (gradient == Gradient::new_) continue;  // its forces pull along rods as they will be
    // That of gradient old is kept by displacements; velocities at the end of a step have it to second order.
    EXPECT_LE(norm(after.angular - before.angular),
              (gradient == Gradient::mid ? 1e-11 : 1e-3) * norm(before.angular));
    if (gradient == Gradient::mid) {
      EXPECT_LE(std::abs(test::energy_of(scene, world, MassModel::consistent) - energy), 1e-11 * energy);
    }
    EXPECT_LE(norm(after.center_of_mass - before.center_of_mass - 5.0 / mass * before.linear), 1e-10);
  }
}

}  // namespace
}  // namespace plumb::PLUMB_TEST_FILE
