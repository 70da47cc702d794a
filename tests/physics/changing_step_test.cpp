// Steps of changing length keep velocity and acceleration.

#include <gtest/gtest.h>

#include <cmath>
#include <vector>

#include "plumb/plumb.hpp"
#include "scenes/generators/generators.hpp"
#include "support/planar_chain.hpp"
#include "support/worlds.hpp"

namespace plumb::PLUMB_TEST_FILE {
namespace {

constexpr Gradient all_gradients[] = {Gradient::new_, Gradient::old, Gradient::mid};

// A free particle stays on its parabola to rounding, whatever the steps: 100 changes, each worth a few
// roundings of a velocity of 20 m/s.
TEST(ChangingStep, FreeFlightStaysExact) {
  Scene scene;
  scene.particles = {test::movable({0, 0, 0}, 1, {3, 10, 0})};
  for (const Gradient gradient : all_gradients) {
    World world(scene, {.method = Method::relax, .gradient = gradient, .substeps = 2, .threads = 1});
    for (int i = 0; i < 100; ++i) {
      world.step(1.0 / (30 + 7 * (i % 13)));
      const double t = world.time();
      ASSERT_LE(norm(world.position(0) - Vec3{3 * t, 10 * t - 9.81 / 2 * t * t, 0}), 1e-12)
          << to_string(gradient);
      ASSERT_LE(norm(world.velocity(0) - Vec3{3, 10 - 9.81 * t, 0}), 1e-12) << to_string(gradient);
    }
  }
}

// A change of step is one error of third order, so a run with one change in it is as accurate as its steps.
TEST(ChangingStep, OnceKeepsAPendulumSecondOrder) {
  test::PlanarChain<1> truth({1}, 0.1L, 9.81L);
  truth.advance(1, 20000);
  const Scene scene = scenes::make_chain(1);
  for (const Gradient gradient : {Gradient::old, Gradient::mid}) {
    double errors[2];
    for (const int k : {0, 1}) {
      World world(scene, {.method = Method::relax,
                          .gradient = gradient,
                          .substeps = 16u << k,
                          .stop = {.sweeps = 100, .tolerance = 1e-13},
                          .threads = 1});
      test::run(world, 1.0 / 60, 30);
      test::run(world, 1.0 / 120, 60);
      errors[k] = rms_distance(test::positions_of(world), truth.frame().positions) / 0.1;
    }
    EXPECT_LE(errors[1], 1e-4) << to_string(gradient);
    EXPECT_NEAR(std::log2(errors[0] / errors[1]), 2, 0.15) << to_string(gradient);
  }
}

// An engine's frames vary all the time, by a tenth here.
TEST(ChangingStep, EveryFrameKeepsAPendulumSecondOrder) {
  test::PlanarChain<1> truth({1}, 0.1L, 9.81L);
  truth.advance(1, 20000);
  const Scene scene = scenes::make_chain(1);
  for (const Gradient gradient : {Gradient::old, Gradient::mid}) {
    double errors[2];
    for (const int k : {0, 1}) {
      World world(scene, {.method = Method::relax,
                          .gradient = gradient,
                          .substeps = 16u << k,
                          .stop = {.sweeps = 100, .tolerance = 1e-13},
                          .threads = 1});
      for (int i = 0; i < 60; ++i) world.step((i % 2 == 0 ? 0.9 : 1.1) / 60);
      errors[k] = rms_distance(test::positions_of(world), truth.frame().positions) / 0.1;
    }
    EXPECT_LE(errors[1], 1e-4) << to_string(gradient);
    EXPECT_NEAR(std::log2(errors[0] / errors[1]), 2, 0.15) << to_string(gradient);
  }
}

// An engine may hand over a frame that is far too short, after a stall or while a window is dragged. Rods
// that sweeps left 1e-4 too long are corrected in it, which at 1/10,000 s looks like a metre a second;
// nothing may be made of that in the next frame of ordinary length. In ordinary frames these chains keep
// their energy to 0.03 of the range.
TEST(ChangingStep, OneShortFrameDoesNoHarm) {
  const Scene scene = scenes::make_chain(10, 0.1, 10);
  for (const Precision precision : {Precision::single, Precision::double_})
    for (const Gradient gradient : all_gradients) {
      World world(scene, {.method = Method::relax,
                          .precision = precision,
                          .gradient = gradient,
                          .substeps = 8,
                          .stop = {.sweeps = 50},
                          .threads = 1});
      test::run(world, 1.0 / 60, 30);
      world.step(1e-4);
      for (int i = 0; i < 10; ++i) {
        world.step(1.0 / 60);
        ASSERT_LE(std::abs(test::relative_energy(scene, world)), 0.1)
            << to_string(precision) << ", gradient " << to_string(gradient) << ", " << i << " frames later";
      }
    }
}

}  // namespace
}  // namespace plumb::PLUMB_TEST_FILE
