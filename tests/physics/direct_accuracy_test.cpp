// Settings::accuracy: substeps are chosen by an estimate of their error.

#include <gtest/gtest.h>

#include <cmath>

#include "scenes/generators.hpp"
#include "support/direct.hpp"
#include "truth/truth.hpp"

namespace plumb {
namespace {

// The error after a second is within three times of what was asked for: the estimate is of each substep's own
// error, which the motion then carries on.
TEST(DirectAccuracy, IsWhatWasAskedFor) {
  for (const std::uint32_t links : {5u, 20u})
    for (const double end_mass : {1.0, 10.0}) {
      const Scene scene = scenes::make_chain(links, 0.1, end_mass);
      const Frame truth = truth::solve(scene, {.save_at = {1}}).frames.front();
      for (const Gradient gradient : {Gradient::old, Gradient::mid})
        for (const double accuracy : {1e-2, 1e-3, 1e-4}) {
          Settings settings = test::direct(gradient);
          settings.accuracy = accuracy;
          World world(scene, settings);
          test::run(world, 1.0 / 60, 60);
          EXPECT_LE(test::relative_error(scene, world, truth.positions), 3 * accuracy)
              << links << " links, end mass " << end_mass << ", gradient " << to_string(gradient)
              << ", asked " << accuracy;
        }
    }
}

// A step that turns out too coarse is done again, from where it began: a blow in the middle of calm.
TEST(DirectAccuracy, RepeatsStepsThatWereTooCoarse) {
  Scene scene = scenes::make_chain(10);
  for (std::uint32_t i = 1; i <= 10; ++i) scene.particles[i].position = {0, -0.1 * i, 0};
  Settings settings = test::direct(Gradient::mid);
  settings.accuracy = 1e-4;
  World world(scene, settings);
  const StepReport calm = test::run(world, 1.0 / 60, 60);
  world.set_force(10, {300, 0, 0});
  const StepReport blow = test::run(world, 1.0 / 60, 2);
  EXPECT_GT(blow.repeated_steps, 0u);
  EXPECT_GT(blow.tree_substeps / 2, calm.tree_substeps / 60);
  EXPECT_LE(test::stretch_of(scene, world).max, 1e-9);
}

// Second order: a hundred times the accuracy for ten times the substeps. Coarser than 1e-4, Newton's own
// limits and the first, cautious substeps decide.
TEST(DirectAccuracy, CostsTheRootOfWhatIsAsked) {
  const Scene scene = scenes::make_chain(20, 0.1, 10);
  const auto substeps = [&](double accuracy) {
    Settings settings = test::direct(Gradient::mid);
    settings.accuracy = accuracy;
    World world(scene, settings);
    return static_cast<double>(test::run(world, 1.0 / 60, 60).tree_substeps);
  };
  EXPECT_LE(substeps(1e-3), substeps(1e-4));
  EXPECT_NEAR(substeps(1e-7) / substeps(1e-5), 10, 3);
}

}  // namespace
}  // namespace plumb
