// What a conservative scene keeps. Energies are relative to the range that the scene can exchange: all of its
// mass falling through the diagonal of its first bounding box.

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "plumb/plumb.hpp"
#include "scenes/generators/generators.hpp"
#include "support/worlds.hpp"

namespace plumb::PLUMB_TEST_FILE {
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

// An exact energy-momentum step keeps energy whatever its length (Simo and Gonzalez). Relaxation aims every
// correction along the middle direction of its moment, which still turns from sweep to sweep, so what is left
// is of second order in the step: for five links let go from the side 6.6e-3, 1.5e-3, 4.0e-4 and 5.9e-5 of
// the range in ten seconds at 4, 8, 16 and 32 substeps. The motion is chaotic, so the order is taken over
// three halvings.
TEST(Energy, GradientMidKeepsItToSecondOrder) {
  const Scene scene = scenes::make_chain(5);
  const auto drift = [&](std::uint32_t substeps) {
    World world(scene, {.method = Method::relax,
                        .gradient = Gradient::mid,
                        .substeps = substeps,
                        .stop = {.sweeps = 20000, .tolerance = 1e-12},
                        .threads = 1});
    return largest_drift(scene, world, 600);
  };
  const double coarse = drift(4), fine = drift(32);
  EXPECT_LE(coarse, 1e-2);
  EXPECT_NEAR(std::log2(coarse / fine) / 3, 2, 0.5);
}

// SHAKE is symplectic: its energy swings with the square of the step and does not drift. The swing of a
// pendulum at h = 1/480 s is 1e-4 of the range at most; what is tested is that ten more seconds add nothing.
TEST(Energy, GradientOldSwingsWithoutDrift) {
  const Scene scene = scenes::make_chain(1, 1);
  const Settings settings{.method = Method::relax,
                          .gradient = Gradient::old,
                          .substeps = 8,
                          .stop = {.sweeps = 1000, .tolerance = 1e-12},
                          .threads = 1};
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
  World world(scene, {.method = Method::relax,
                      .gradient = Gradient::new_,
                      .substeps = 8,
                      .stop = {.sweeps = 100},
                      .threads = 1});
  double before = test::relative_energy(scene, world);
  for (int second = 0; second < 5; ++second) {
    test::run(world, 1.0 / 60, 60);
    const double now = test::relative_energy(scene, world);
    EXPECT_LT(now, before - 1e-3);
    before = now;
  }
}

}  // namespace
}  // namespace plumb::PLUMB_TEST_FILE
