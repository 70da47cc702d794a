// What a conservative scene keeps. Energies are relative to the range that the scene can exchange: all of its
// mass falling through the diagonal of its first bounding box.

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "plumb/plumb.hpp"
#include "scenes/generators.hpp"
#include "support/worlds.hpp"

namespace plumb {
namespace {

using test::movable;

/// Largest change of relative energy at the ends of `steps` steps of 1/60 s.
double largest_drift(const Scene& scene, World& world, int steps) {
  const double before = test::relative_energy(scene, world);
  double largest = 0;
  for (int i = 0; i < steps; ++i) {
    world.step(1.0 / 60);
    largest = std::max(largest, std::abs(test::relative_energy(scene, world) - before));
  }
  return largest;
}

// The violation is quadratic in positions, so J(middle) (x_new - x_old) = C_new - C_old: once rods keep their
// length their forces do no work, whatever the step (Simo and Gonzalez' energy-momentum scheme). With C at
// 1e-13 of L^2 the work left per substep is a tension times 1e-13 L / 2, at most a few weights of 5 links:
// 1e-13 of the range, and 2,400 substeps of it stay below 1e-9 even if all had one sign.
TEST(Energy, GradientMidKeepsItOnceConverged) {
  const Scene scene = scenes::make_chain(5);
  World world(scene, {.gradient = Gradient::mid,
                      .substeps = 4,
                      .stop = {.sweeps = 10000, .tolerance = 1e-13},
                      .threads = 1});
  EXPECT_LE(largest_drift(scene, world, 600), 1e-9);
}

// Newton's third law along the line of sight: the same forces have no moment either.
TEST(Energy, GradientMidKeepsItInThreeDimensions) {
  Scene scene;
  scene.particles = {test::fixed({0, 0, 0}), movable({0.3, 0, 0}, 1, {0, 0, 2}),
                     movable({0.3, 0.4, 0}, 5, {0, 0, 1})};
  scene.rods = {{.a = 0, .b = 1}, {.a = 1, .b = 2}};
  World world(scene, {.gradient = Gradient::mid,
                      .substeps = 4,
                      .stop = {.sweeps = 10000, .tolerance = 1e-13},
                      .threads = 1});
  EXPECT_LE(largest_drift(scene, world, 600), 1e-9);
}

// SHAKE is symplectic: its energy swings with the square of the step and does not drift. The swing of a
// pendulum at h = 1/480 s is 1e-4 of the range at most; what is tested is that ten more seconds add nothing.
TEST(Energy, GradientOldSwingsWithoutDrift) {
  const Scene scene = scenes::make_chain(1, 1);
  const Settings settings{
      .gradient = Gradient::old, .substeps = 8, .stop = {.sweeps = 1000, .tolerance = 1e-12}, .threads = 1};
  World world(scene, settings);
  const double first = largest_drift(scene, world, 600);
  const double second = largest_drift(scene, world, 600);
  EXPECT_LE(first, 2e-4);
  EXPECT_LE(second, 1.1 * first);

  Settings twice = settings;
  twice.substeps *= 2;
  World finer(scene, twice);
  EXPECT_NEAR(std::log2(first / largest_drift(scene, finer, 600)), 2, 0.15);
}

// The projection of the thesis only ever takes energy: a pendulum let go comes back lower every time.
TEST(Energy, GradientNewLosesIt) {
  const Scene scene = scenes::make_chain(1, 1);
  World world(scene, {.gradient = Gradient::new_, .substeps = 8, .stop = {.sweeps = 100}, .threads = 1});
  double before = test::relative_energy(scene, world);
  for (int second = 0; second < 5; ++second) {
    test::run(world, 1.0 / 60, 60);
    const double now = test::relative_energy(scene, world);
    EXPECT_LT(now, before - 1e-3);
    before = now;
  }
}

}  // namespace
}  // namespace plumb
