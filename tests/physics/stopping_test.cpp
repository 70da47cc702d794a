// When sweeps stop, what that guarantees, and how it is reported.

#include <gtest/gtest.h>

#include <cmath>
#include <string>

#include "plumb/plumb.hpp"
#include "scenes/generators/generators.hpp"
#include "support/worlds.hpp"

namespace plumb::PLUMB_TEST_FILE {
namespace {

constexpr Gradient all_gradients[] = {Gradient::new_, Gradient::old, Gradient::mid};

/// A ring of rods hung from one particle of it, out of plane, masses from 1 to 3 kg. (Flat nets will not do
/// for small tolerances: they swing through positions in which no force along a rod can keep it.)
Scene ring(std::uint32_t rods) {
  Scene scene;
  for (std::uint32_t i = 0; i < rods; ++i) {
    const double turn = 2 * std::acos(-1.0) * i / rods;
    scene.particles.push_back(test::movable({std::cos(turn), std::sin(turn), 0.1 * (i % 3)}, 1 + i % 3));
    scene.rods.push_back({.a = i, .b = (i + 1) % rods});
  }
  scene.particles[0] = test::fixed(scene.particles[0].position);
  return scene;
}

// A step that reports `tolerance` leaves every rod within it, stretched or compressed. What the world checks
// is the displacement; adding it to a position rounds once more, by 1 unit in the last place of 1 m over a
// rod of 0.1 m.
TEST(Tolerance, HoldsForEveryRodAfterEveryStep) {
  struct Case {
    Precision precision;
    double tolerance, rounding;
  };
  for (const Case c : {Case{Precision::double_, 1e-3, 1e-14}, Case{Precision::double_, 1e-9, 1e-14},
                       Case{Precision::single, 1e-3, 5e-6}, Case{Precision::single, 1e-4, 5e-6}})
    for (const Gradient gradient : all_gradients)
      for (const Scene& scene :
           {scenes::make_chain(12, 0.1, 5), ring(9), scenes::make_ensemble({.chains = 20, .links = 5})}) {
        World world(scene, {.method = Method::relax,
                            .precision = c.precision,
                            .gradient = gradient,
                            .substeps = 4,
                            .stop = {.sweeps = 100000, .tolerance = c.tolerance},
                            .threads = 1});
        for (int i = 0; i < 20; ++i) {
          const StepReport report = world.step(1.0 / 60);
          ASSERT_EQ(report.stopped_by, StoppedBy::tolerance);
          const Stretch stretch = test::stretch_of(scene, world);
          ASSERT_LE(stretch.max, c.tolerance + c.rounding)
              << to_string(c.precision) << ", gradient " << to_string(gradient) << ", rod "
              << stretch.max_rod;
        }
      }
}

// Bounds of a rod's squared length are not symmetric: a tolerance of 20 % allows 44 % more but only 36 %
// less. A rod pushed together must not slip through.
TEST(Tolerance, HoldsForCompressedRods) {
  Scene scene;
  scene.gravity = {};
  scene.particles = {test::fixed({0, 0, 0}), test::movable({0.79, 0, 0}), test::fixed({0, 0, 1}),
                     test::movable({0.81, 0, 1})};
  scene.rods = {{.a = 0, .b = 1, .length = 1}, {.a = 2, .b = 3, .length = 1}};
  // Layout aos puts both islands into one block; each for itself then.
  for (const std::size_t rod : {0u, 1u}) {
    Scene one;
    one.gravity = {};
    one.particles = {scene.particles[2 * rod], scene.particles[2 * rod + 1]};
    one.rods = {{.a = 0, .b = 1, .length = 1}};
    World world(one, {.method = Method::relax, .stop = {.sweeps = 10, .tolerance = 0.2}, .threads = 1});
    const StepReport report = world.step(1.0 / 60);
    EXPECT_EQ(report.skipped_within_tolerance, rod == 1 ? 1u : 0u);
    EXPECT_EQ(report.block_sweeps, rod == 1 ? 0u : 1u);
    EXPECT_LE(test::stretch_of(one, world).max, 0.2);
  }
}

TEST(StoppedBy, SweepsAtTheirNumber) {
  const Scene scene = scenes::make_chain(20, 0.1, 10);
  World world(scene, {.method = Method::relax, .substeps = 3, .stop = {.sweeps = 7}, .threads = 1});
  const StepReport report = world.step(1.0 / 60);
  EXPECT_EQ(report.stopped_by, StoppedBy::sweeps);
  EXPECT_EQ(report.substeps, 3u);
  EXPECT_EQ(report.block_sweeps, 3u * 7);
  EXPECT_EQ(report.rod_projections, 3u * 7 * 20);
}

TEST(StoppedBy, SweepsWhenToleranceIsOutOfReach) {
  World world(scenes::make_chain(20, 0.1, 10),
              {.method = Method::relax, .stop = {.sweeps = 5, .tolerance = 1e-12}, .threads = 1});
  const StepReport report = world.step(1.0 / 60);
  EXPECT_EQ(report.stopped_by, StoppedBy::sweeps);
  EXPECT_EQ(report.block_sweeps, 5u);
  EXPECT_EQ(report.skipped_within_tolerance, 0u);
}

TEST(StoppedBy, ToleranceBeforeTheNumberOfSweeps) {
  World world(scenes::make_chain(3),
              {.method = Method::relax, .stop = {.sweeps = 1000, .tolerance = 1e-6}, .threads = 1});
  const StepReport report = world.step(1.0 / 60);
  EXPECT_EQ(report.stopped_by, StoppedBy::tolerance);
  EXPECT_GT(report.block_sweeps, 0u);
  EXPECT_LT(report.block_sweeps, 1000u);
}

// A budget no sweep can meet still does one; one that no sweep can exhaust leaves the number of sweeps in
// charge.
TEST(StoppedBy, BudgetAfterAtLeastOneSweep) {
  World world(scenes::make_chain(2000),
              {.method = Method::relax, .stop = {.sweeps = 1000000, .budget_us = 1e-3}, .threads = 1});
  const StepReport report = world.step(1.0 / 60);
  EXPECT_EQ(report.stopped_by, StoppedBy::budget);
  EXPECT_GE(report.block_sweeps, 1u);
  EXPECT_LT(report.block_sweeps, 1000000u);
  world.set_stop_rule({.sweeps = 3, .budget_us = 1e12});
  EXPECT_EQ(world.step(1.0 / 60).stopped_by, StoppedBy::sweeps);
}

TEST(StoppedBy, NothingWithoutRods) {
  Scene scene;
  scene.particles = {test::movable({}, 1)};
  World world(scene, {.method = Method::relax, .threads = 1});
  const StepReport report = world.step(1.0 / 60);
  EXPECT_EQ(report.stopped_by, StoppedBy::nothing);
  EXPECT_EQ(report.rod_projections, 0u);
}

// The latest in the list where islands differ: a loose chain is done at once, a net is not.
TEST(StoppedBy, IsTheLatestOfAllIslands) {
  Scene scene = scenes::make_net(12, 12);
  const auto first = static_cast<std::uint32_t>(scene.particles.size());
  scene.particles.push_back(test::movable({0, 0, 5}));
  scene.particles.push_back(test::movable({1, 0, 5}));
  scene.rods.push_back({.a = first, .b = first + 1});
  World world(scene, {.method = Method::relax, .stop = {.sweeps = 4, .tolerance = 1e-10}, .threads = 1});
  const StepReport report = world.step(1.0 / 60);
  EXPECT_EQ(report.stopped_by, StoppedBy::sweeps);
  EXPECT_EQ(report.skipped_within_tolerance, 1u) << "the loose rod falls freely";
}

// Rods that no force stretches are looked at, not swept: a chain falling freely, in every substep.
TEST(SkippedWithinTolerance, CountsBlocksAndSubsteps) {
  Scene scene;
  for (std::uint32_t i = 0; i < 6; ++i) scene.particles.push_back(test::movable({0.5 * i, 0, 0}));
  for (std::uint32_t i = 0; i < 5; ++i) scene.rods.push_back({.a = i, .b = i + 1});
  World world(
      scene,
      {.method = Method::relax, .substeps = 6, .stop = {.sweeps = 10, .tolerance = 1e-6}, .threads = 1});
  const StepReport report = test::run(world, 1.0 / 60, 5);
  EXPECT_EQ(report.skipped_within_tolerance, 6u * 5);
  EXPECT_EQ(report.block_sweeps, 0u);
  EXPECT_EQ(report.stopped_by, StoppedBy::tolerance);
}

TEST(StopRules, ChangeAtRunTime) {
  const Scene scene = scenes::make_chain(10, 0.1, 10);
  World world(scene, {.method = Method::relax, .stop = {.sweeps = 2}, .threads = 1});
  EXPECT_EQ(test::run(world, 1.0 / 60, 10).block_sweeps, 20u);
  EXPECT_GT(test::stretch_of(scene, world).max, 1e-3);
  world.set_stop_rule({.sweeps = 100000, .tolerance = 1e-9});
  EXPECT_EQ(world.step(1.0 / 60).stopped_by, StoppedBy::tolerance);
  EXPECT_LE(test::stretch_of(scene, world).max, 1.001e-9);
}

// Over-relaxation changes how sweeps get there, not where. Gradient old corrects along fixed directions, so
// there is one solution, and runs that converge to 1e-11 of each rod are less than 1e-7 m apart after a
// second. The other gradients correct along directions that change on the way; what that changes is of the
// method's own third order.
TEST(OverRelaxation, ConvergesToTheSameMotion) {
  for (const Scene& scene : {scenes::make_chain(10, 0.1, 10), ring(9)})
    for (const Gradient gradient : {Gradient::new_, Gradient::old}) {
      const auto run_with = [&](double omega) {
        World world(scene, {.method = Method::relax,
                            .gradient = gradient,
                            .omega = omega,
                            .substeps = 8,
                            .stop = {.sweeps = 100000, .tolerance = 1e-11},
                            .threads = 1});
        const StepReport report = test::run(world, 1.0 / 60, 30);
        EXPECT_EQ(report.stopped_by, StoppedBy::tolerance);
        return std::pair{test::positions_of(world), report.block_sweeps};
      };
      const auto [plain, plain_sweeps] = run_with(1);
      const auto [relaxed, relaxed_sweeps] = run_with(1.9);
      EXPECT_LE(rms_distance(plain, relaxed), gradient == Gradient::old ? 1e-7 : 1e-4)
          << "gradient " << to_string(gradient);
      if (scene.rods.size() == 10) {  // the chain; the ring needs few sweeps anyway
        EXPECT_LT(relaxed_sweeps, plain_sweeps) << "gradient " << to_string(gradient);
      }
    }
}

}  // namespace
}  // namespace plumb::PLUMB_TEST_FILE
