// Velocities of method direct: those given at first, and those read at the end of a step.

#include <gtest/gtest.h>

#include <cmath>
#include <vector>

#include "scenes/generators/generators.hpp"
#include "support/dense_constraints.hpp"
#include "support/direct.hpp"
#include "support/random_trees.hpp"
#include "support/truths.hpp"

namespace plumb::PLUMB_TEST_FILE {
namespace {

/// Random velocities projected by one dense matrix: M v' = M v + J^T lambda, J v' = 0.
std::vector<Vec3> projected_densely(const Scene& scene, MassModel model) {
  const test::DenseConstraints dense(scene, model);
  const auto n = dense.unknowns();
  test::DenseConstraints::Vector v = test::DenseConstraints::Vector::Zero(dense.matrix().rows());
  for (std::size_t i = 0; i < scene.particles.size(); ++i) {
    const Vec3 given = scene.particles[i].velocity;
    if (dense.row(i) >= 0) v.segment<3>(dense.row(i)) << given.x, given.y, given.z;
  }
  v.head(n) = dense.matrix().topLeftCorner(n, n) * v.head(n);
  const auto solved = dense.solve(v);
  std::vector<Vec3> result(scene.particles.size());
  for (std::size_t i = 0; i < scene.particles.size(); ++i) {
    if (dense.row(i) < 0) continue;
    const auto r = dense.row(i);
    result[i] = {static_cast<double>(solved[r]), static_cast<double>(solved[r + 1]),
                 static_cast<double>(solved[r + 2])};
  }
  return result;
}

// What pulls on rods is taken out with the mass of the rods themselves: velocities of about 1 m/s to 1e-12.
TEST(DirectVelocities, AreProjectedWithTheMassOfRods) {
  test::Random random(31);
  for (int round = 0; round < 20; ++round) {
    Scene scene = test::random_tree(
        random, {.movable = 2 + test::below(random, 12), .anchors = 1, .masses = 3, .rod_mass = 2});
    for (Particle& particle : scene.particles) particle.velocity = test::random_vector(random);
    for (const MassModel mass : {MassModel::lumped, MassModel::consistent}) {
      const World world(scene, test::direct(Gradient::mid, 1, mass));
      const std::vector<Vec3> wanted = projected_densely(scene, mass), got = test::velocities_of(world);
      double change = 0;
      for (std::size_t i = 0; i < wanted.size(); ++i) {
        ASSERT_LE(norm(got[i] - wanted[i]), 1e-12) << round << ", " << to_string(mass);
        if (!scene.particles[i].fixed) change = std::max(change, norm(got[i] - scene.particles[i].velocity));
      }
      EXPECT_NEAR(world.info().projected_velocity, change, 1e-15);
    }
  }
}

// At the end of every step the velocities of gradients old and new stretch no rod, to rounding.
TEST(DirectVelocities, FitTheRods) {
  for (const Gradient gradient : {Gradient::old, Gradient::new_}) {
    for (Scene scene : {scenes::make_tree(), scenes::make_chain(20, 0.1, 10)}) {
      World world(scene, test::direct(gradient, 2));
      for (int i = 0; i < 60; ++i) {
        world.step(1.0 / 60);
        for (std::uint32_t p = 0; p < scene.particles.size(); ++p)
          scene.particles[p].position = world.position(p);
        ASSERT_LE(test::largest_stretching_rate(scene, test::velocities_of(world)), 1e-12)
            << to_string(gradient) << ", step " << i;
      }
    }
  }
}

// An anchor that moves carries what hangs from it: lifted straight up at a constant speed, a chain at rest
// below it has that speed, from the first step on.
TEST(DirectVelocities, AreThoseOfTheAnchorThatCarriesThem) {
  for (const Gradient gradient : {Gradient::old, Gradient::mid, Gradient::new_})
    for (const double rod_mass : {0.0, 2.0}) {
      Scene scene;
      scene.particles = {test::fixed({0, 0, 0}), test::movable({0, -1, 0}), test::movable({0, -2, 0})};
      scene.rods = {{.a = 0, .b = 1, .mass = rod_mass}, {.a = 1, .b = 2, .mass = rod_mass}};
      World world(scene, test::direct(gradient, 2));
      for (int i = 1; i <= 10; ++i) {
        world.move_anchor(0, {0, 0.01 * i, 0});
        world.step(0.01);
        for (const std::uint32_t p : {1u, 2u})
          EXPECT_LE(norm(world.velocity(p) - Vec3{0, 1, 0}), 1e-9)
              << to_string(gradient) << ", rods of " << rod_mass << " kg, step " << i;
      }
    }
}

}  // namespace
}  // namespace plumb::PLUMB_TEST_FILE
