// Initial velocities that pull on rods are projected onto those that do not, by impulses along the rods.

#include <gtest/gtest.h>

#include <cmath>
#include <string>
#include <vector>

#include "plumb/plumb.hpp"
#include "scenes/generators/generators.hpp"
#include "support/graphs.hpp"
#include "support/worlds.hpp"

namespace plumb::PLUMB_TEST_FILE {
namespace {

using test::movable;

Vec3 random_vector(test::Random& random) {
  const double x = test::signed_unit(random), y = test::signed_unit(random), z = test::signed_unit(random);
  return {x, y, z};
}

std::vector<Vec3> given_velocities(const Scene& scene) {
  std::vector<Vec3> velocities;
  for (const Particle& particle : scene.particles)
    velocities.push_back(particle.fixed ? Vec3{} : particle.velocity);
  return velocities;
}

/// Largest difference between two fields, in m/s.
double largest_change(const std::vector<Vec3>& a, const std::vector<Vec3>& b) {
  double largest = 0;
  for (std::size_t i = 0; i < a.size(); ++i) largest = std::max(largest, norm(b[i] - a[i]));
  return largest;
}

/// What every projection must do. `scene` has random velocities of about 1 m/s; 1e-10 of that is what the
/// header promises to leave.
void expect_projected(const Scene& scene, double left = 1e-10) {
  const World world(scene, {.method = Method::relax, .threads = 1});
  const std::vector<Vec3> given = given_velocities(scene), projected = test::velocities_of(world);
  ASSERT_GT(test::largest_stretching_rate(scene, given), 0.01) << "nothing to project";
  EXPECT_LE(test::largest_stretching_rate(scene, projected), left);
  EXPECT_NEAR(world.info().projected_velocity, largest_change(given, projected), 1e-15);
  // The smallest change weighted by mass is perpendicular to what is left: energy falls by exactly the
  // change's own.
  const std::vector<double> masses = lumped_masses(scene);
  double before = 0, after = 0, change = 0;
  for (std::size_t i = 0; i < masses.size(); ++i) {
    if (scene.particles[i].fixed) continue;
    before += masses[i] * dot(given[i], given[i]);
    after += masses[i] * dot(projected[i], projected[i]);
    change += masses[i] * dot(given[i] - projected[i], given[i] - projected[i]);
  }
  EXPECT_NEAR(before - after, change, 1e-9 * before);
}

void give_velocities(Scene& scene, unsigned seed) {
  test::Random random(seed);
  for (Particle& particle : scene.particles) particle.velocity = random_vector(random);
}

// One rod between masses 1 and 3, each end pulled outwards: the impulse along the rod takes the velocity
// along it from both to that of the centre of mass, and leaves what is across.
TEST(InitialVelocities, OfOneRodByHand) {
  Scene scene;
  scene.particles = {movable({0, 0, 0}, 1, {-4, 1, 0}), movable({2, 0, 0}, 3, {0, 0, 5})};
  scene.rods = {{.a = 0, .b = 1}};
  const World world(scene, {.method = Method::relax, .threads = 1});
  EXPECT_LE(norm(world.velocity(0) - Vec3{-1, 1, 0}), 1e-15);
  EXPECT_LE(norm(world.velocity(1) - Vec3{-1, 0, 5}), 1e-15);
  EXPECT_NEAR(world.info().projected_velocity, 3, 1e-15);
}

TEST(InitialVelocities, ThatDoNotPullAreKeptToTheBit) {
  Scene scene;  // turning about its middle, and drifting
  scene.particles = {movable({0, 0, 0}, 1, {1, 2, 0}), movable({1, 0, 0}, 3, {1, 3, 0})};
  scene.rods = {{.a = 0, .b = 1}};
  const World world(scene, {.method = Method::relax, .threads = 1});
  EXPECT_EQ(world.velocity(0), (Vec3{1, 2, 0}));
  EXPECT_EQ(world.velocity(1), (Vec3{1, 3, 0}));
  EXPECT_EQ(world.info().projected_velocity, 0);
}

TEST(InitialVelocities, OfChainsNetsAndGraphs) {
  Scene chain = scenes::make_chain(20, 0.1, 10);
  give_velocities(chain, 1);
  expect_projected(chain);
  Scene net = scenes::make_net(9, 7);
  give_velocities(net, 2);
  expect_projected(net);
  Scene graph = scenes::make_graph({.particles = 300});
  give_velocities(graph, 3);
  expect_projected(graph);
}

// More rods than freedoms: a cube with all its edges, face diagonals and space diagonals (28 rods for 24 -
// 6). The matrix of the impulses is singular; the velocities are unique all the same.
TEST(InitialVelocities, OfAnOverbracedTruss) {
  Scene scene;
  scene.gravity = {};
  for (unsigned corner = 0; corner < 8; ++corner)
    scene.particles.push_back(
        movable({corner & 1 ? 1.0 : 0.0, corner & 2 ? 1.0 : 0.0, corner & 4 ? 1.0 : 0.0}, 1.0 + corner));
  for (std::uint32_t a = 0; a < 8; ++a)
    for (std::uint32_t b = a + 1; b < 8; ++b) scene.rods.push_back({.a = a, .b = b});
  give_velocities(scene, 4);
  expect_projected(scene);

  // Rigid: what is left is the rigid motion with the same linear and angular momentum.
  const World world(scene, {.method = Method::relax, .threads = 1});
  const auto positions = test::positions_of(world);
  const Momentum given = measure_momentum(scene, positions, given_velocities(scene));
  const Momentum kept = measure_momentum(scene, positions, test::velocities_of(world));
  EXPECT_LE(norm(kept.linear - given.linear), 1e-10);
  EXPECT_LE(norm(kept.angular - given.angular), 1e-10);
}

TEST(InitialVelocities, KeepAFreeBodysMomenta) {
  Scene scene;
  test::Random random(6);
  for (std::uint32_t i = 0; i <= 10; ++i) {
    scene.particles.push_back(movable(random_vector(random), 0.1 + i, random_vector(random)));
    if (i > 0) scene.rods.push_back({.a = i - 1, .b = i});
  }
  expect_projected(scene);
  const World world(scene, {.method = Method::relax, .threads = 1});
  const auto positions = test::positions_of(world);
  const Momentum given = measure_momentum(scene, positions, given_velocities(scene));
  const Momentum kept = measure_momentum(scene, positions, test::velocities_of(world));
  EXPECT_LE(norm(kept.linear - given.linear), 1e-12);
  EXPECT_LE(norm(kept.angular - given.angular), 1e-12);
}

// How heavy one island is must not decide how well another is projected.
TEST(InitialVelocities, OfHeavyAndLightBodiesTogether) {
  Scene scene;
  scene.gravity = {};
  double z = 0;
  for (const double mass : {1e6, 1.0, 1e-6}) {
    const auto first = static_cast<std::uint32_t>(scene.particles.size());
    scene.particles.push_back(movable({0, 0, z}, mass, {-1, 0, 0}));
    scene.particles.push_back(movable({1, 0, z}, mass, {1, 0, 0}));
    scene.rods.push_back({.a = first, .b = first + 1});
    z += 1;
  }
  expect_projected(scene);
}

// In one chain as well: masses 1e-6 to 1e6 in turn.
TEST(InitialVelocities, OfAChainOfHeavyAndLightParticles) {
  Scene scene = scenes::make_chain(30);
  for (std::size_t i = 1; i < scene.particles.size(); ++i)
    scene.particles[i].mass = std::pow(10, static_cast<double>(i % 3) * 6 - 6);
  give_velocities(scene, 7);
  expect_projected(scene);
}

// Pulled evenly along its length, every rod of a straight chain is pulled the same way: the slowest of all
// patterns to get rid of, and the longer the chain the slower. From a fixed root, nothing may be left of it.
TEST(InitialVelocities, OfALongStraightChain) {
  Scene scene = scenes::make_chain(100000);
  for (Particle& particle : scene.particles) particle.velocity.x = particle.position.x / 1e4;
  const World world(scene, {.method = Method::relax, .threads = 1});
  const std::vector<Vec3> projected = test::velocities_of(world);
  EXPECT_LE(test::largest_stretching_rate(scene, projected), 1e-10);
  EXPECT_LE(norm(projected.back()), 1e-6);
}

}  // namespace
}  // namespace plumb::PLUMB_TEST_FILE
