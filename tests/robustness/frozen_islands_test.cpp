// An island whose numbers run out is put back to its last finite state, stands still from then on, is counted
// once, and harms no other.

#include <gtest/gtest.h>

#include <cmath>
#include <string>
#include <vector>

#include "plumb/plumb.hpp"
#include "scenes/generators/generators.hpp"
#include "support/executors.hpp"
#include "support/worlds.hpp"

namespace plumb::PLUMB_TEST_FILE {
namespace {

constexpr LayoutChoice all_layouts[] = {LayoutChoice::automatic, LayoutChoice::aos, LayoutChoice::soa,
                                        LayoutChoice::aosoa};
constexpr Precision all_precisions[] = {Precision::single, Precision::double_};

void append(Scene& scene, const Scene& added) {
  const auto first = static_cast<std::uint32_t>(scene.particles.size());
  scene.particles.insert(scene.particles.end(), added.particles.begin(), added.particles.end());
  for (Rod rod : added.rods) {
    rod.a += first;
    rod.b += first;
    scene.rods.push_back(rod);
  }
}

/// More than any number can hold once it is multiplied by h^2.
Vec3 breaking_force(Precision precision) {
  return {precision == Precision::single ? 1e300 : 1e308, 0, 0};
}

/// A particle of 1e-8 kg makes that infinite in double as well.
Scene breakable_chain(std::uint32_t links) {
  return scenes::make_chain(links, 0.1, 1e-8);
}

// Islands of the same shape (lanes of one register), of another (another block) and none in particular
// (loose): each has the bits it has in a world without the one that breaks.
TEST(FrozenIslands, LeaveTheOthersBitsAlone) {
  const Scene others_scene = [] {
    Scene scene = scenes::make_ensemble({.chains = 40, .links = 6, .vary = 0.5});
    append(scene, scenes::make_net(5, 9));
    append(scene, scenes::make_graph({.particles = 80}));
    scene.particles.push_back(test::movable({1, 1, 1}, 1, {1, 0, 0}));
    return scene;
  }();
  for (const Precision precision : all_precisions)
    for (const LayoutChoice layout : all_layouts)
      for (const Gradient gradient : {Gradient::new_, Gradient::old})
        for (const std::uint32_t links : {6u, 17u}) {
          const Settings settings{.method = Method::relax,
                                  .precision = precision,
                                  .gradient = gradient,
                                  .stop = {.sweeps = 5},
                                  .layout = layout,
                                  .threads = 1};
          Scene scene = others_scene;
          append(scene, breakable_chain(links));
          World world(scene, settings), without(others_scene, settings);
          const auto victim = world.particle_count() - 1;
          StepReport report;
          for (int i = 0; i < 30; ++i) {
            if (i == 10) world.set_force(victim, breaking_force(precision));
            report += world.step(1.0 / 60);
            without.step(1.0 / 60);
            ASSERT_TRUE(test::all_finite(world));
          }
          EXPECT_EQ(report.frozen_islands, 1u);
          for (std::uint32_t i = 0; i < without.particle_count(); ++i) {
            ASSERT_EQ(world.position(i), without.position(i))
                << to_string(precision) << ", " << to_string(layout) << ", particle " << i;
            ASSERT_EQ(world.velocity(i), without.velocity(i));
          }
        }
}

// Back to where it was before the substep that broke it, and there for good, stretched rods and all: what is
// left of its numbers may not be trusted with a motion.
TEST(FrozenIslands, StandStillWhereTheyWere) {
  for (const Precision precision : all_precisions)
    for (const LayoutChoice layout : all_layouts)
      for (const Gradient gradient : {Gradient::new_, Gradient::old, Gradient::mid}) {
        SCOPED_TRACE(testing::Message() << to_string(precision) << ", " << to_string(layout) << ", gradient "
                                        << to_string(gradient));
        const Scene scene = breakable_chain(10);
        World world(scene, {.method = Method::relax,
                            .precision = precision,
                            .gradient = gradient,
                            .stop = {.sweeps = 2},  // leaves rods stretched
                            .layout = layout,
                            .threads = 1});
        test::run(world, 1.0 / 60, 10);
        ASSERT_GT(test::stretch_of(scene, world).max, 1e-6);
        const std::vector<Vec3> before = test::positions_of(world);
        world.set_force(10, breaking_force(precision));
        EXPECT_EQ(world.step(1.0 / 60).frozen_islands, 1u);
        EXPECT_EQ(test::positions_of(world), before);
        EXPECT_EQ(test::velocities_of(world), std::vector<Vec3>(11));

        world.set_force(10, {});
        world.set_force(5, {1, 2, 3});
        world.step(1.0 / 90);
        EXPECT_EQ(test::run(world, 1.0 / 60, 60).frozen_islands, 0u) << "counted again";
        EXPECT_EQ(test::positions_of(world), before);
        EXPECT_EQ(test::velocities_of(world), std::vector<Vec3>(11));
      }
}

// With substeps: the last finite state is that of the last whole substep, here the first of two.
TEST(FrozenIslands, KeepTheSubstepsBefore) {
  Scene scene;
  scene.gravity = {};
  scene.particles = {test::movable({0, 0, 0}, 1, {1, 0, 0})};
  World world(scene, {.method = Method::relax, .substeps = 2, .threads = 1});
  world.set_force(0, {1e308, 0, 0});  // 1.25e307 after h^2 = 1/8: the third substep passes 1.8e308
  StepReport report;
  Vec3 last = world.position(0);
  for (int i = 0; i < 50 && report.frozen_islands == 0; ++i) {
    last = world.position(0);
    report += world.step(0.5);
  }
  EXPECT_EQ(report.frozen_islands, 1u);
  EXPECT_GE(world.position(0).x, last.x);
  EXPECT_TRUE(test::all_finite(world));
}

// Not only displacements: a position that passes the largest number has no next one either.
TEST(FrozenIslands, PositionsDoNotRunOutUnseen) {
  Scene scene;
  scene.gravity = {};
  scene.particles = {test::movable({0, 0, 0}, 1, {1e38, 0, 0}), test::movable({0, 5, 0}, 1, {1, 0, 0})};
  World world(scene, {.method = Method::relax, .precision = Precision::single, .threads = 1});
  StepReport report;
  for (int i = 0; i < 6; ++i) {
    report += world.step(1);
    ASSERT_TRUE(test::all_finite(world)) << "step " << i;
  }
  EXPECT_EQ(report.frozen_islands, 1u);
  EXPECT_EQ(world.position(1), (Vec3{6, 5, 0}));
}

TEST(FrozenIslands, AreCountedOneByOne) {
  const Scene scene = scenes::make_ensemble({.chains = 50, .links = 3, .end_mass = 1e-8});
  for (const LayoutChoice layout : all_layouts) {
    World world(scene, {.method = Method::relax, .stop = {.sweeps = 5}, .layout = layout, .threads = 1});
    world.step(1.0 / 60);
    for (const std::uint32_t chain : {3u, 4u, 31u, 49u}) world.set_force(4 * chain + 3, {1e308, 0, 0});
    EXPECT_EQ(world.step(1.0 / 60).frozen_islands, 4u) << to_string(layout);
    world.set_force(4 * 7 + 3, {1e308, 0, 0});
    EXPECT_EQ(world.step(1.0 / 60).frozen_islands, 1u) << to_string(layout);
    EXPECT_TRUE(test::all_finite(world));
    EXPECT_GT(norm(world.velocity(3)), 0.1) << "chain 0 swings on";
  }
}

// The same in a block that two threads share.
TEST(FrozenIslands, InBlocksSharedByThreads) {
  test::PoolExecutor pool(2);
  detail::EagerExecutor eager(pool, test::early);
  for (Scene scene : {scenes::make_chain(5000, 0.1, 1e-8), scenes::make_net(64, 48)}) {
    const auto victim = static_cast<std::uint32_t>(scene.particles.size() - 1);
    scene.particles[victim].mass = 1e-8;
    World alone(scene, {.method = Method::relax, .stop = {.sweeps = 4}, .threads = 1});
    World shared(scene, {.method = Method::relax, .stop = {.sweeps = 4}, .threads = 2, .executor = &eager});
    ASSERT_TRUE(shared.info().parallel);
    for (World* world : {&alone, &shared}) {
      test::run(*world, 1.0 / 60, 5);
      const std::vector<Vec3> before = test::positions_of(*world);
      world->set_force(victim, {1e308, 0, 0});
      EXPECT_EQ(world->step(1.0 / 60).frozen_islands, 1u);
      EXPECT_EQ(test::positions_of(*world), before);
    }
    EXPECT_EQ(alone.state_hash(), shared.state_hash());
  }
}

// An anchor that several islands share is none of them.
TEST(FrozenIslands, DoNotHoldACommonAnchor) {
  Scene scene;
  scene.particles = {test::fixed({0, 0, 0}), test::movable({1, 0, 0}, 1e-8), test::movable({0, 0, 1}),
                     test::movable({0, 0, 2})};
  scene.rods = {{.a = 0, .b = 1}, {.a = 0, .b = 2}, {.a = 2, .b = 3}};
  for (const LayoutChoice layout : all_layouts) {
    World world(scene, {.method = Method::relax, .stop = {.sweeps = 50}, .layout = layout, .threads = 1});
    world.step(1.0 / 60);
    world.set_force(1, {1e308, 0, 0});
    EXPECT_EQ(world.step(1.0 / 60).frozen_islands, 1u);
    const Vec3 stuck = world.position(1);
    for (int i = 1; i <= 60; ++i) {
      world.move_anchor(0, {0, 0, -0.01 * i});
      world.step(1.0 / 60);
    }
    EXPECT_NEAR(world.position(0).z, -0.6, 1e-12) << to_string(layout);
    EXPECT_NEAR(norm(world.position(2) - world.position(0)), 1, 1e-2) << to_string(layout);
    EXPECT_EQ(world.position(1), stuck) << to_string(layout);
  }
}

}  // namespace
}  // namespace plumb::PLUMB_TEST_FILE
