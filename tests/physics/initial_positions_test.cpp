// Scenes whose rods do not start at their lengths: method direct moves particles there, by mass, before the
// first step.

#include <gtest/gtest.h>

#include <cmath>
#include <vector>

#include "scenes/generators.hpp"
#include "support/direct.hpp"
#include "support/random_trees.hpp"

namespace plumb {
namespace {

/// Every coordinate off by up to `by` metres, rods as long as they were.
Scene shaken(Scene scene, double by, test::Random& random) {
  for (std::size_t i = 0; i < scene.rods.size(); ++i) scene.rods[i].length = rod_length(scene, i);
  for (Particle& particle : scene.particles)
    if (!particle.fixed) particle.position = particle.position + by * test::random_vector(random);
  return scene;
}

void expect_at_rest(const Scene& scene, const Settings& settings, double left) {
  World world(scene, settings);
  EXPECT_GT(world.info().projected_position, 0);
  EXPECT_LE(test::stretch_of(scene, world).max, left);
  const std::vector<Vec3> before = test::positions_of(world);
  const StepReport report = test::run(world, 1.0 / 60, 10);
  EXPECT_EQ(report.unsolved, 0u);
  const std::vector<Vec3> after = test::positions_of(world);
  for (std::size_t i = 0; i < before.size(); ++i) EXPECT_LE(norm(after[i] - before[i]), 10 * left) << i;
}

// Without loads nothing moves then, however short substeps are: the gap did not become a velocity.
TEST(InitialPositions, BringNoVelocity) {
  test::Random random(7);
  for (int round = 0; round < 12; ++round) {
    Scene tree = test::random_tree(
        random,
        {.movable = 2 + test::below(random, 12), .anchors = round % 2 ? 1u : 0u, .masses = 3, .rod_mass = 2});
    tree.gravity = {};
    tree = shaken(tree, 0.005, random);
    for (const Gradient gradient : {Gradient::old, Gradient::mid, Gradient::new_}) {
      SCOPED_TRACE(std::to_string(round) + ", " + std::string(to_string(gradient)));
      for (const std::uint32_t substeps : {1u, 100u})
        expect_at_rest(tree, test::direct(gradient, substeps), 1e-12);
      Settings accurate = test::direct(gradient);
      accurate.accuracy = 1e-6;
      expect_at_rest(tree, accurate, 1e-12);
    }
  }
}

// In loops, by factors and by lines, and in lines cut into segments.
TEST(InitialPositions, BringNoVelocityToLoopsAndLongLines) {
  test::Random random(8);
  for (Scene scene :
       {scenes::make_ring({.links = 12}), scenes::make_net({.width = 12, .height = 12, .level = 1}),
        scenes::make_chain(200, 0.1, 10)}) {
    scene.gravity = {};
    scene = shaken(scene, 0.002, random);
    for (const Gradient gradient : {Gradient::old, Gradient::mid}) {
      SCOPED_TRACE(std::to_string(scene.rods.size()) + " rods, " + std::string(to_string(gradient)));
      expect_at_rest(scene, test::direct(gradient, 4), 1e-9);
    }
  }
}

// Rods push and pull along themselves, so what floats keeps its centre of mass.
TEST(InitialPositions, KeepTheCentreOfMass) {
  test::Random random(9);
  const Scene scene = shaken(
      test::random_tree(random, {.movable = 10, .anchors = 0, .masses = 3, .rod_mass = 2}), 0.01, random);
  const World world(scene, test::direct(Gradient::mid));
  const std::vector<Vec3> still(scene.particles.size());
  std::vector<Vec3> given;
  for (const Particle& particle : scene.particles) given.push_back(particle.position);
  const Vec3 before = measure_momentum(scene, given, still, MassModel::consistent).center_of_mass;
  const Vec3 after =
      measure_momentum(scene, test::positions_of(world), still, MassModel::consistent).center_of_mass;
  EXPECT_LE(norm(after - before), 1e-12);
  EXPECT_GT(world.info().projected_position, 1e-3);
}

// What fits but for the rounding of its coordinates stays where it was put, to the last bit.
TEST(InitialPositions, StayWhereRodsFit) {
  for (const Scene& scene :
       {scenes::make_chain(20, 0.1, 10), scenes::make_tree(), scenes::make_ring({.links = 12})}) {
    const World world(scene, test::direct(Gradient::mid));
    EXPECT_EQ(world.info().projected_position, 0);
    for (std::uint32_t i = 0; i < scene.particles.size(); ++i)
      EXPECT_EQ(world.position(i), scene.particles[i].position);
  }
}

}  // namespace
}  // namespace plumb
