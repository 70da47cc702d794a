// Constant forces on particles.

#include <gtest/gtest.h>

#include <cmath>
#include <vector>

#include "plumb/plumb.hpp"
#include "scenes/generators/generators.hpp"
#include "support/worlds.hpp"

namespace plumb::PLUMB_TEST_FILE {
namespace {

constexpr Gradient all_gradients[] = {Gradient::new_, Gradient::old, Gradient::mid};

Scene chain(Vec3 gravity) {
  Scene scene = scenes::make_chain(8, 0.25, 4, 2);
  scene.gravity = gravity;
  scene.drag = 0.5;
  return scene;
}

// A force of mass times acceleration on every particle is gravity. With masses and accelerations that are
// small binary fractions the sum does not round, and the worlds are the same to the bit.
TEST(Forces, OnEveryParticleAreGravity) {
  const Vec3 gravity{0, -10, 0}, extra{2.5, 0, -0.75};
  for (const Gradient gradient : all_gradients) {
    const Settings settings{
        .method = Method::relax, .gradient = gradient, .substeps = 4, .stop = {.sweeps = 30}, .threads = 1};
    const Scene pushed_scene = chain(gravity);
    World pushed(pushed_scene, settings), heavier(chain(gravity + extra), settings);
    const std::vector<double> masses = lumped_masses(pushed_scene);
    for (std::uint32_t i = 1; i < masses.size(); ++i) pushed.set_force(i, masses[i] * extra);
    test::run(pushed, 1.0 / 60, 60);
    test::run(heavier, 1.0 / 60, 60);
    EXPECT_EQ(pushed.state_hash(), heavier.state_hash()) << to_string(gradient);
  }
}

TEST(Forces, LastUntilTheyAreChanged) {
  Scene scene;
  scene.gravity = {};
  scene.particles = {test::movable({}, 2), test::movable({1, 0, 0}, 2)};
  for (const Gradient gradient : all_gradients) {
    World world(scene, {.method = Method::relax, .gradient = gradient, .threads = 1});
    world.set_force(0, {3, 0, 0});
    test::run(world, 0.125, 8);
    EXPECT_NEAR(world.velocity(0).x, 1.5, 1e-14);  // F t/m
    EXPECT_NEAR(world.position(0).x, 0.75, 1e-14);
    EXPECT_EQ(world.velocity(1), Vec3{}) << "not pushed";
    world.set_force(0, {});
    test::run(world, 0.125, 8);
    // Momentum changes by the force's impulse, no more and no less.
    EXPECT_NEAR(world.velocity(0).x, 1.5, 1e-14) << to_string(gradient);
    EXPECT_NEAR(world.position(0).x, 0.75 + 1.5, 1e-14) << to_string(gradient);
    const Vec3 coasting = world.velocity(0);
    test::run(world, 0.125, 8);
    EXPECT_NEAR(world.velocity(0).x, coasting.x, 1e-14) << to_string(gradient);
  }
}

// Pulling sideways with the weight of the chain: once drag has eaten the swing, it hangs at 45 degrees.
TEST(Forces, ShiftWhereAChainHangs) {
  Scene scene = scenes::make_chain(4, 0.25, 1, 1);
  scene.drag = 4;
  World world(
      scene,
      {.method = Method::relax, .substeps = 4, .stop = {.sweeps = 200, .tolerance = 1e-12}, .threads = 1});
  for (std::uint32_t i = 1; i <= 4; ++i) world.set_force(i, {9.81, 0, 0});
  test::run(world, 1.0 / 60, 60 * 20);
  for (std::uint32_t i = 1; i <= 4; ++i) {
    EXPECT_NEAR(world.position(i).x, 0.25 * i * std::sqrt(0.5), 1e-9);
    EXPECT_NEAR(world.position(i).y, -0.25 * i * std::sqrt(0.5), 1e-9);
  }
}

}  // namespace
}  // namespace plumb::PLUMB_TEST_FILE
