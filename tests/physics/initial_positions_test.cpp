// Scenes whose rods do not start at their lengths: method direct moves particles there, by mass, before the
// first step.

#include <gtest/gtest.h>

#include <cmath>
#include <string>
#include <vector>

#include "scenes/generators/generators.hpp"
#include "support/direct.hpp"
#include "support/random_trees.hpp"

namespace plumb::PLUMB_TEST_FILE {
namespace {

/// Every coordinate off by up to `by` metres, rods as long as they were.
Scene shaken(Scene scene, double by, test::Random& random) {
  for (std::size_t i = 0; i < scene.rods.size(); ++i) scene.rods[i].length = rod_length(scene, i);
  for (Particle& particle : scene.particles)
    if (!particle.fixed) particle.position = particle.position + by * test::random_vector(random);
  return scene;
}

/// To `tolerance`: of a strain 1e-12 is what Newton's last change leaves squared, 1e-9 where lines or many
/// rods add up; ten steps may add as much each.
void expect_at_rest(const Scene& scene, const Settings& settings, double tolerance) {
  World world(scene, settings);
  EXPECT_GT(world.info().projected_position, 0);
  EXPECT_LE(test::stretch_of(scene, world).max, tolerance);
  const std::vector<Vec3> before = test::positions_of(world);
  const StepReport report = test::run(world, 1.0 / 60, 10);
  EXPECT_EQ(report.unsolved, 0u);
  const std::vector<Vec3> after = test::positions_of(world);
  for (std::size_t i = 0; i < before.size(); ++i) EXPECT_LE(norm(after[i] - before[i]), 10 * tolerance) << i;
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

// In float, too; and of equal trees side by side only those that do not fit are moved.
TEST(InitialPositions, AreProjectedTreeByTree) {
  test::Random random(10);
  Scene fits = scenes::make_chain(6, 0.1, 3);
  fits.gravity = {};
  Scene scene = fits;
  for (int k = 1; k < 12; ++k) {
    const Scene other = k % 3 ? fits : shaken(fits, 0.002, random);
    const auto first = static_cast<std::uint32_t>(scene.particles.size());
    for (Particle particle : other.particles) {
      particle.position = particle.position + Vec3{0, 0, 1.0 * k};
      scene.particles.push_back(particle);
    }
    for (Rod rod : other.rods) {
      rod.length = 0.1;
      rod.a += first;
      rod.b += first;
      scene.rods.push_back(rod);
    }
  }
  for (const Precision precision : {Precision::single, Precision::double_}) {
    Settings settings = test::direct(Gradient::mid, 4);
    settings.precision = precision;
    const World world(scene, settings);
    const double tolerance = precision == Precision::single ? 1e-6 : 1e-12;
    EXPECT_LE(test::stretch_of(scene, world).max, tolerance);
    for (std::uint32_t i = 0; i < scene.particles.size(); ++i) {
      const bool shaken_chain = i / fits.particles.size() > 0 && i / fits.particles.size() % 3 == 0;
      if (shaken_chain) continue;
      EXPECT_LE(norm(world.position(i) - scene.particles[i].position), tolerance) << i;
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

// What cannot be brought there is counted: fixed ends farther apart than the rods between them reach. Rods
// share what they lack: 0.12 m each, so that the last particle goes from 0.4 to 0.48 m.
TEST(InitialPositions, SayWhatDoesNotFit) {
  Scene scene = scenes::make_chain(4);
  scene.particles.push_back(test::fixed({0.6, 0, 0}));
  scene.rods.push_back({.a = 4, .b = 5, .length = 0.1});
  const World world(scene, test::direct(Gradient::mid));
  EXPECT_EQ(world.info().unprojected_islands, 1u);
  EXPECT_NEAR(world.info().projected_position, 0.08, 1e-6);
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
}  // namespace plumb::PLUMB_TEST_FILE
