// Towers and walls of boxes stand, sleep and weigh what they weigh, on every kind of level ground.

#include <gtest/gtest.h>

#include <algorithm>

#include "support/boxes.hpp"

namespace plumb::PLUMB_TEST_FILE {
namespace {

using test::frame;

constexpr int boxes = 10;
constexpr double mass = 2;

/// A tower of boxes of 40 x 20 x 40 cm, every other one a centimetre aside if it `leans`.
Scene tower_on(const Scene& ground, bool leans, int count = boxes) {
  Scene scene = ground;
  for (int i = 0; i < count; ++i)
    test::add_box(scene, {leans ? 0.01 * ((7 * i) % 5 - 2) : 0, 0.1 + 0.2 * i, 0}, {0.2, 0.1, 0.2}, mass,
                  {.friction = 0.6});
  return scene;
}

// Boxes start where they stand. Each sinks into what is below by at most the slop of 0.5 mm, or by less where
// sweeps share the weight out, so that none goes down by more than a millimetre. Nor does it go aside by
// more.
TEST(Tower, OfTenBoxesStandsAndSleeps) {
  for (const auto& [name, ground] : test::level_grounds({.friction = 0.6}))
    for (const bool leans : {false, true}) {
      SCOPED_TRACE(testing::Message() << name << (leans ? ", leaning" : ""));
      const Scene scene = tower_on(ground, leans);
      World world(scene, test::body_settings(4, true));
      std::uint64_t awake = 1;
      while (awake > 0 && world.time() < 2) {
        const StepReport report = world.step(frame);
        ASSERT_EQ(report.unsolved, 0u);
        awake = report.awake_islands;
      }
      EXPECT_EQ(awake, 0u);
      for (std::uint32_t i = 0; i < boxes; ++i)
        EXPECT_LT(norm(test::middle_of(scene, world, i) - scene.bodies[i].center), 1.5e-3) << i;
    }
}

// Every box is pushed up by what it weighs: what is below pushes with all that it carries, and what is above
// pushes down. Means over a second are off by what a sweep may leave, 4e-3 of a weight.
TEST(Tower, WeighsWhatItWeighs) {
  for (const auto& [name, ground] : test::level_grounds({.friction = 0.6})) {
    SCOPED_TRACE(name);
    const Scene scene = tower_on(ground, false);
    Settings settings = test::body_settings(4);
    settings.tensions = true;
    World world(scene, settings);
    test::run(world, frame, 60);
    std::vector<double> pushes(boxes);
    for (int i = 0; i < 60; ++i) {
      world.step(frame);
      for (std::uint32_t k = 0; k < boxes; ++k) pushes[k] += world.contact_force(k).y / 60;
    }
    for (std::uint32_t k = 0; k < boxes; ++k)
      EXPECT_NEAR(pushes[k], mass * test::earth, 4e-3 * mass * test::earth) << k;
  }
}

// Taller ones stand, too, with default settings, and cost little. Where contacts changed their places from
// substep to substep they took two million sweeps, cut in 64 parts. Sweeps without momentum were 108,000, and
// those with friction from the first on up to 90,000.
TEST(Tower, OfTwentyBoxesCostsLittle) {
  for (const int count : {13, 14, 15, 16, 20}) {
    Scene ground;
    ground.planes = {{.surface = {.friction = 0.6}}};
    const Scene scene = tower_on(ground, false, count);
    World world(scene, {.threads = 1});
    StepReport all;
    for (int i = 0; i < 120; ++i) all += world.step(frame);
    EXPECT_EQ(all.unsolved, 0u) << count;
    EXPECT_LT(all.block_sweeps, 20'000u) << count;
    for (std::uint32_t i = 0; i < scene.bodies.size(); ++i)
      EXPECT_LT(norm(world.pose(i).position - scene.bodies[i].center), 2e-3) << count << ", " << i;
  }
}

/// Bricks of 20 x 10 x 10 cm that touch exactly, each row half a brick aside of the one below. Rows of a
/// pyramid get shorter, so that each brick stands on two.
Scene wall_of(int width, int rows, bool is_pyramid) {
  Scene scene;
  scene.planes.push_back({});
  for (int row = 0; row < rows; ++row)
    for (int i = 0; i < width - (is_pyramid ? row : 0); ++i)
      test::add_box(scene, {0.2 * i + 0.1 * (is_pyramid ? row : row % 2), 0.05 + 0.1 * row, 0},
                    {0.1, 0.05, 0.05}, 1, {});
  return scene;
}

// Nothing is known of pushes in the first step. Found from nothing, they and friction strained these walls,
// and were not found in 4,000 sweeps and ten halvings, which took half a second. Bricks stand where they were
// to a tenth of the slop, and a step takes no more sweeps than some ten for each row.
TEST(BrickWall, StandsFromTheFirstStepOn) {
  for (const bool is_pyramid : {false, true})
    for (const std::uint32_t substeps : {1u, 4u}) {
      SCOPED_TRACE(testing::Message() << (is_pyramid ? "pyramid, " : "wall, ") << substeps);
      const Scene scene = wall_of(10, 9, is_pyramid);
      World world(scene, {.substeps = substeps, .threads = 1});
      StepReport report;
      do {
        report = world.step(frame);
        EXPECT_EQ(report.unsolved + report.halvings, 0u);
        EXPECT_LE(report.block_sweeps, substeps * 120u);
      } while (report.awake_islands > 0 && world.time() < 2);
      EXPECT_EQ(report.awake_islands, 0u);
      for (std::uint32_t i = 0; i < scene.bodies.size(); ++i)
        EXPECT_LT(norm(test::middle_of(scene, world, i) - scene.bodies[i].center), 5e-5) << i;
    }
}

}  // namespace
}  // namespace plumb::PLUMB_TEST_FILE
