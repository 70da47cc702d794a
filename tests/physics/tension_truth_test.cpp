// Tensions against truth, whose own are those of a pendulum.

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <vector>

#include "plumb/error.hpp"
#include "scenes/files/trajectory.hpp"
#include "scenes/spec.hpp"
#include "support/refusals.hpp"
#include "support/worlds.hpp"
#include "truth/truth.hpp"

namespace plumb::PLUMB_TEST_FILE {
namespace {

constexpr double frame = 1.0 / 60;

TEST(TrueTensions, OfAPendulumHoldItsWeightOnItsCircle) {
  Scene scene;
  scene.particles = {test::fixed({}), test::movable({0.6, -0.8, 0}, 2)};
  scene.rods = {{.a = 0, .b = 1}};
  // The mean over a short time is the pull at its middle, to the square of that time.
  constexpr double mean = 1e-5;
  const truth::Truth truth = truth::solve(scene, {.save_at = {0, 0.1}, .mean_over = mean});
  EXPECT_TRUE(std::isnan(truth.frames[0].tensions[0])) << "at the start";
  const truth::Truth at = truth::solve(scene, {.save_at = {0.3}});
  const truth::Truth about = truth::solve(scene, {.save_at = {0.3 + mean / 2}, .mean_over = mean});
  const Vec3 x = at.frames[0].positions[1], v = at.frames[0].velocities[1];
  const double expected = 2 * (dot(v, v) - 9.81 * x.y);
  EXPECT_NEAR(about.frames[0].tensions[0], expected, 1e-7);
  EXPECT_LT(about.tension, 1e-12);
}

// What is hauled straight up at one speed weighs what it weighs, however short its rod has become.
TEST(TrueTensions, OfAWinchHoldTheWeight) {
  Scene scene;
  scene.particles = {test::fixed({}), test::movable({0, -1, 0}, 2)};
  scene.particles[1].velocity = {0, 0.5, 0};
  scene.rods = {{.a = 0, .b = 1}};
  const truth::Truth truth =
      truth::solve(scene, {.save_at = {0.5, 1}, .mean_over = frame, .rates = {{.rod = 0, .rate = -0.5}}});
  for (const Frame& at : truth.frames) EXPECT_NEAR(at.tensions[0], 2 * 9.81, 1e-12);
}

TEST(TrueTensions, OfMeansThatOverlapOrOfRedundantRodsAreRefused) {
  const Scene chain = scenes::load_scene("chain:links=2");
  EXPECT_NE(test::refusal([&] { truth::solve(chain, {.save_at = {0.1, 0.105}, .mean_over = 0.01}); }), "");
  EXPECT_NE(test::refusal([&] { truth::solve(chain, {.save_at = {0.005}, .mean_over = 0.01}); }), "");
}

/// The error of tensions after a quarter of a second, relative to the truth's.
double error(const Scene& scene, const Frame& truth, Settings settings, std::uint32_t substeps) {
  settings.substeps = substeps;
  settings.tensions = true;
  World world(scene, settings);
  test::run(world, frame, 15);
  Frame now;
  now.tensions.resize(world.rod_count());
  world.copy_tensions(now.tensions);
  return scenes::tension_error(now, truth).relative;
}

// Gradients mid and old, and linkages, which have both halves of a substep's pull.
TEST(TrueTensions, AreApproachedWithTheSquareOfTheSubstep) {
  for (const char* spec : {"chain:links=5,end_mass=10", "chain:links=5,end_mass=10,stiffness=1e4"}) {
    const Scene scene = scenes::load_scene(spec);
    const Frame truth = truth::solve(scene, {.save_at = {15 * frame}, .mean_over = frame}).frames[0];
    Scene linkage = scene;  // a spring that does nothing makes it one
    linkage.springs.push_back({.a = {{0}, {1}}, .b = {{1}, {1}}, .stiffness = 1e-12});
    for (const Gradient gradient : {Gradient::mid, Gradient::old}) {
      const Settings settings{.method = Method::direct, .gradient = gradient};
      const double order = std::log2(error(scene, truth, settings, 16) / error(scene, truth, settings, 32));
      EXPECT_NEAR(order, 2, 0.2) << spec << ", gradient " << to_string(gradient);
    }
    const Settings direct{.method = Method::direct};
    const double of_linkage =
        std::log2(error(linkage, truth, direct, 16) / error(linkage, truth, direct, 32));
    EXPECT_NEAR(of_linkage, 2, 0.2) << spec;
    EXPECT_LT(error(linkage, truth, direct, 32), 1e-3);
  }
}

TEST(TrueTensions, OfAWinchAreApproachedWithTheSquareOfTheSubstep) {
  Scene scene = scenes::load_scene("chain:links=3,end_mass=5");
  constexpr double rate = -0.1;
  const Frame truth =
      truth::solve(scene, {.save_at = {15 * frame}, .mean_over = frame, .rates = {{.rod = 0, .rate = rate}}})
          .frames[0];
  const auto error_of = [&](Gradient gradient, std::uint32_t substeps) {
    World world(scene,
                {.method = Method::direct, .gradient = gradient, .substeps = substeps, .tensions = true});
    for (int i = 1; i <= 15; ++i) {
      world.set_length(0, rod_length(scene, 0) + i * frame * rate);
      world.step(frame);
    }
    Frame now;
    now.tensions.resize(world.rod_count());
    world.copy_tensions(now.tensions);
    return scenes::tension_error(now, truth).relative;
  };
  for (const Gradient gradient : {Gradient::mid, Gradient::old})
    EXPECT_NEAR(std::log2(error_of(gradient, 16) / error_of(gradient, 32)), 2, 0.2) << to_string(gradient);
}

// What composed substeps count is composed as they are. Trees with an accuracy take them.
TEST(TrueTensions, AreApproachedByComposedSubsteps) {
  const Scene scene = scenes::load_scene("chain:links=5,end_mass=10");
  const Frame truth = truth::solve(scene, {.save_at = {15 * frame}, .mean_over = frame}).frames[0];
  const Settings fourth{.method = Method::direct, .gradient = Gradient::old, .time_order = 4};
  EXPECT_GT(std::log2(error(scene, truth, fourth, 4) / error(scene, truth, fourth, 8)), 4);
  EXPECT_LT(error(scene, truth, {.accuracy = 1e-7}, 1), 1e-8);
}

}  // namespace
}  // namespace plumb::PLUMB_TEST_FILE
