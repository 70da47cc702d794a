// Forces, drag and steps of changing length with method direct.

#include <gtest/gtest.h>

#include <cmath>

#include "scenes/generators/generators.hpp"
#include "support/direct.hpp"
#include "support/truths.hpp"
#include "truth/truth.hpp"

namespace plumb::PLUMB_TEST_FILE {
namespace {

constexpr Gradient all_gradients[] = {Gradient::new_, Gradient::old, Gradient::mid};

// A force on the end of a rod with mass that balances gravity: half the rod's weight and the particle's.
TEST(DirectForces, HoldWhatTheyBalance) {
  for (const Gradient gradient : all_gradients) {
    Scene scene;
    scene.particles = {test::fixed({0, 0, 0}), test::movable({1, 0, 0}, 2)};
    scene.rods = {{.a = 0, .b = 1, .mass = 3}};
    World world(scene, test::direct(gradient, 2));
    world.set_force(1, {0, 9.81 * 3.5, 0});
    test::run(world, 1.0 / 60, 120);
    EXPECT_LE(norm(world.position(1) - Vec3{1, 0, 0}), 1e-12) << to_string(gradient);
    world.set_force(1, {});
    test::run(world, 1.0 / 60, 10);
    EXPECT_LT(world.position(1).y, -0.05) << to_string(gradient);
  }
}

/// A force that sets in after half a second, on a free particle: two parabolas, exactly.
void expect_sets_in(Gradient gradient) {
  Scene scene;
  scene.particles = {test::movable({0, 0, 0}, 2)};
  scene.gravity = {};
  World world(scene, test::direct(gradient, 4));
  test::run(world, 0.01, 50);
  world.set_force(0, {4, 0, 0});
  EXPECT_EQ(world.velocity(0), Vec3{}) << "a force is no impulse";
  test::run(world, 0.01, 50);
  EXPECT_NEAR(world.position(0).x, 0.25, 1e-12);
  EXPECT_NEAR(world.velocity(0).x, 1, 1e-12);
}
TEST(DirectForces, SetInWhenTheyAreSet) {
  expect_sets_in(Gradient::mid);
}
TEST(DirectForces, SetInWhenTheyAreSetWithGradientOld) {
  expect_sets_in(Gradient::old);
}

// Velocities decay as exp(-ct) to rounding, whatever the step, also of rods that turn freely.
TEST(DirectForces, DragDecaysExactly) {
  for (const Gradient gradient : all_gradients) {
    Scene scene;
    scene.particles = {test::movable({0, 0, 0}, 1, {3, 2, 1})};
    scene.gravity = {};
    scene.drag = 0.7;
    World world(scene, test::direct(gradient));
    test::run(world, 0.1, 20);
    EXPECT_LE(norm(world.velocity(0) - std::exp(-1.4) * Vec3{3, 2, 1}), 1e-13) << to_string(gradient);
    const double exact = 3 / 0.7 * (1 - std::exp(-1.4));
    EXPECT_NEAR(world.position(0).x, exact, 1e-3 * exact) << "second order: (ch)^2/24";
  }
}

// Against the truth, second order.
TEST(DirectForces, DragOnATree) {
  Scene scene = scenes::make_tree();
  scene.drag = 1.3;
  const Frame truth = truth::solve(scene, {.save_at = {0.5}}).frames.front();
  for (const Gradient gradient : {Gradient::old, Gradient::mid}) {
    double errors[2];
    for (const std::uint32_t i : {0u, 1u}) {
      World world(scene, test::direct(gradient, 8u << i));
      test::run(world, 1.0 / 60, 30);
      errors[i] = rms_distance(test::positions_of(world), truth.positions);
    }
    EXPECT_NEAR(errors[0] / errors[1], 4, 0.3) << to_string(gradient);
    EXPECT_LE(errors[1], 1e-3) << to_string(gradient);
  }
}

// Steps of 1/60 s and a third of it in turn: second order all the same, and energy is kept by mid.
TEST(DirectForces, StepsOfChangingLength) {
  const Scene scene = test::double_pendulum();
  const Frame truth = truth::solve(scene, {.save_at = {0.5}}).frames.front();
  for (const Gradient gradient : {Gradient::old, Gradient::mid}) {
    double errors[2];
    for (const std::uint32_t i : {0u, 1u}) {
      World world(scene, test::direct(gradient, 32u << i));
      for (int k = 0; k < 30; ++k) world.step((k % 3 == 0 ? 2.0 : 0.5) / 60);
      errors[i] = rms_distance(test::positions_of(world), truth.positions);
    }
    EXPECT_NEAR(errors[0] / errors[1], 4, 0.4) << to_string(gradient);
  }
  World world(scene, test::direct(Gradient::mid));
  const double before = test::relative_energy(scene, world);
  for (int k = 0; k < 300; ++k) world.step((1 + k % 5) / 200.0);
  EXPECT_NEAR(test::relative_energy(scene, world), before, 1e-11);
}

}  // namespace
}  // namespace plumb::PLUMB_TEST_FILE
