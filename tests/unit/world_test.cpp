#include "plumb/world.hpp"

#include <gtest/gtest.h>

#include <memory>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "scenes/generators/generators.hpp"
#include "support/refusals.hpp"
#include "support/worlds.hpp"

namespace plumb::PLUMB_TEST_FILE {
namespace {

/// A chain of 20 rods, five equal chains of 3, a net of 4 x 5, a loose particle and a fixed one: 1 + 5 + 1 +
/// 1 islands.
Scene mixture() {
  Scene scene = scenes::make_chain(20);
  for (const Scene& more :
       {scenes::make_ensemble({.chains = 5, .links = 3, .end_mass = 1}), scenes::make_net(4, 5)}) {
    const auto first = static_cast<std::uint32_t>(scene.particles.size());
    scene.particles.insert(scene.particles.end(), more.particles.begin(), more.particles.end());
    for (Rod rod : more.rods) {
      rod.a += first;
      rod.b += first;
      scene.rods.push_back(rod);
    }
  }
  scene.particles.push_back(test::movable({1, 2, 3}));
  scene.particles.push_back(test::fixed({4, 5, 6}));
  return scene;
}

TEST(World, CountsWhatItHolds) {
  const Scene scene = mixture();
  for (const LayoutChoice layout :
       {LayoutChoice::automatic, LayoutChoice::aos, LayoutChoice::soa, LayoutChoice::aosoa}) {
    const World world(scene, {.method = Method::relax, .layout = layout, .threads = 1});
    const WorldInfo& info = world.info();
    EXPECT_EQ(world.particle_count(), scene.particles.size());
    EXPECT_EQ(world.rod_count(), scene.rods.size());
    EXPECT_EQ(info.particles, scene.particles.size());
    EXPECT_EQ(info.rods, scene.rods.size());
    EXPECT_EQ(info.islands, 8u);
    EXPECT_EQ(info.threads, 1u);
    EXPECT_FALSE(info.parallel);
    EXPECT_TRUE(info.skipped_drag);
    std::uint32_t rods = 0, islands = 0, particles = 0;
    for (const BlockInfo& block : info.blocks) {
      rods += block.rods;
      islands += block.islands;
      particles += block.particles;
      EXPECT_GE(block.uniform_fraction, 0);
      EXPECT_LE(block.uniform_fraction, 1);
      EXPECT_GT(block.bytes, 0u);
      if (layout != LayoutChoice::automatic) {
        EXPECT_EQ(block.layout, to_string(layout));
      }
    }
    EXPECT_EQ(rods, info.rods) << to_string(layout);
    EXPECT_EQ(islands, info.islands) << to_string(layout);
    // Here no particle hangs in two islands, and one fixed particle holds nothing.
    EXPECT_EQ(particles + 1, info.particles) << to_string(layout);
  }
}

// In a chain all rods but the one at the anchor weigh the same at both ends; with unequal masses hardly any
// do.
TEST(World, CountsRodsThatNeedNoWeights) {
  const World equal(scenes::make_chain(5000), {.method = Method::relax, .threads = 1});
  EXPECT_GT(equal.info().skipped_per_rod_weights, 4000u);
  EXPECT_LT(equal.info().skipped_per_rod_weights, 5000u);
  Scene scene = scenes::make_chain(5000);
  for (std::size_t i = 1; i < scene.particles.size(); ++i)
    scene.particles[i].mass = 1 + 0.001 * static_cast<double>(i);
  EXPECT_EQ(World(scene, {.method = Method::relax, .threads = 1}).info().skipped_per_rod_weights, 0u);
  // Halves for everyone: only the anchor's rod still differs.
  World by_halves(scene, {.method = Method::relax, .threads = 1});
  by_halves.set_weights(Weights::equal);
  EXPECT_GT(by_halves.info().skipped_per_rod_weights, 4000u);
}

TEST(World, StartsAsTheSceneSays) {
  Scene scene = mixture();
  scene.drag = 0.1;
  scene.particles[20].velocity = {0, 0, 3};  // across its rod
  scene.particles.back().velocity = {1, 1, 1};
  const World world(scene, {.method = Method::relax, .threads = 1});
  for (std::uint32_t i = 0; i < world.particle_count(); ++i)
    EXPECT_EQ(world.position(i), scene.particles[i].position);
  EXPECT_EQ(world.velocity(20), (Vec3{0, 0, 3}));
  EXPECT_EQ(world.velocity(world.particle_count() - 1), Vec3{}) << "a fixed particle has none";
  EXPECT_EQ(world.time(), 0);
  EXPECT_FALSE(world.info().skipped_drag);
}

TEST(World, IsReadInThreeWays) {
  World world(mixture(), {.method = Method::relax, .threads = 1});
  test::run(world, 1.0 / 60, 5);
  const std::vector<Vec3> positions = test::positions_of(world), velocities = test::velocities_of(world);
  ASSERT_EQ(world.positions().size(), positions.size());
  for (std::uint32_t i = 0; i < positions.size(); ++i) {
    EXPECT_EQ(world.positions()[i], positions[i]);
    EXPECT_EQ(world.position(i), positions[i]);
    EXPECT_EQ(world.velocities()[i], velocities[i]);
    EXPECT_EQ(world.velocity(i), velocities[i]);
  }
}

// Whether a world has a copy of its scene changes no bit. What is shared lives as long as anyone has it, and
// scenes of now do not change it.
TEST(World, SharesItsSceneOrCopiesIt) {
  auto scene = std::make_shared<const Scene>(mixture());
  World copy(*scene), one(scene), other(scene);
  EXPECT_EQ(scene.use_count(), 3)
      << "the test and two worlds; kinds of islands share it, too, if there are any";
  scene.reset();
  for (World* const world : {&copy, &one, &other}) {
    world->cut(3);
    world->step(1.0 / 60);
    world->set_settings({.substeps = 2});
    world->step(1.0 / 60);
  }
  EXPECT_EQ(one.state_hash(), copy.state_hash());
  EXPECT_EQ(other.state_hash(), copy.state_hash());
  EXPECT_EQ(test::refusal([] { World(std::shared_ptr<const Scene>()); }),
            "a world needs a scene, and there is none");
}

TEST(World, MovesWithItsState) {
  const Scene scene = mixture();
  World world(scene, {.method = Method::relax, .threads = 1}),
      twin(scene, {.method = Method::relax, .threads = 1});
  test::run(world, 1.0 / 60, 5);
  test::run(twin, 1.0 / 60, 10);
  World moved(std::move(world));
  test::run(moved, 1.0 / 60, 5);
  EXPECT_EQ(moved.state_hash(), twin.state_hash());
  EXPECT_NEAR(moved.time(), 10.0 / 60, 1e-15);
  moved = World(scene, {.method = Method::relax, .threads = 1});
  EXPECT_EQ(moved.time(), 0);
}

// The world keeps no reference to its scene.
TEST(World, OutlivesItsScene) {
  Scene scene = mixture();
  World world(scene, {.method = Method::relax, .threads = 1}),
      twin(mixture(), {.method = Method::relax, .threads = 1});
  scene = {};
  test::run(world, 1.0 / 60, 5);
  test::run(twin, 1.0 / 60, 5);
  EXPECT_EQ(world.state_hash(), twin.state_hash());
}

// A scene in which nothing may touch has no stage for it.
// What falls for the longest step is still where coordinates in float can be.
TEST(World, RefusesStepsThatAreTooLong) {
  Scene scene;
  scene.particles = {test::movable({1, 2, 3})};
  for (const Precision precision : {Precision::single, Precision::double_}) {
    World world(scene, {.method = Method::relax, .precision = precision});
    for (const double dt : {1.1e7, 1e300})
      EXPECT_NE(test::refusal([&] { world.step(dt); }).find("too long"), std::string::npos);
    EXPECT_EQ(world.time(), 0);
    EXPECT_EQ(world.step(1e7).frozen_islands, 0u);
    EXPECT_NEAR(world.position(0).y / (-0.5 * 9.81 * 1e14), 1, 1e-6);
  }
}

TEST(Zones, HearOfTheStagesThatAStepHas) {
  Scene scene = scenes::make_chain(3);
  for (const bool has_contact : {false, true}) {
    if (has_contact) scene.capsules.push_back({.a = point_at(0), .b = point_at(1), .radius = 0.01});
    World world(scene, {.threads = 1});
    std::string heard;
    world.set_zones([&](std::string_view stage, bool begins) {
      heard += (begins ? "<" : "") + std::string(stage) + (begins ? "" : ">") + ' ';
    });
    world.step(0.01);
    EXPECT_EQ(heard, std::string("<split split> <wake wake> ") + (has_contact ? "<collide collide> " : "") +
                         "<solve solve> <sleep sleep> <measure measure> ");
    heard.clear();
    world.set_zones({});
    world.step(0.01);
    EXPECT_EQ(heard, "");
  }
}

TEST(StepReport, AddsUp) {
  StepReport a, b;
  a.substeps = 1;
  a.block_sweeps = 2;
  a.rod_projections = 3;
  a.stopped_by = StoppedBy::sweeps;
  a.skipped_within_tolerance = 4;
  a.mid_guarded = 5;
  a.frozen_islands = 6;
  b = a;
  b.stopped_by = StoppedBy::tolerance;
  b += a;
  EXPECT_EQ(b.substeps, 2u);
  EXPECT_EQ(b.block_sweeps, 4u);
  EXPECT_EQ(b.rod_projections, 6u);
  EXPECT_EQ(b.stopped_by, StoppedBy::sweeps) << "the later of the two";
  EXPECT_EQ(b.skipped_within_tolerance, 8u);
  EXPECT_EQ(b.mid_guarded, 10u);
  EXPECT_EQ(b.frozen_islands, 12u);
}

TEST(ToString, NamesWhatStopped) {
  EXPECT_EQ(to_string(StoppedBy::nothing), "nothing");
  EXPECT_EQ(to_string(StoppedBy::tolerance), "tolerance");
  EXPECT_EQ(to_string(StoppedBy::sweeps), "sweeps");
  EXPECT_EQ(to_string(StoppedBy::budget), "budget");
}

}  // namespace
}  // namespace plumb::PLUMB_TEST_FILE
