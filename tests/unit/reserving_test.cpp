// Room that a world makes for what edits will add.

#include <gtest/gtest.h>

#include <cstdint>
#include <string>
#include <vector>

#include "plumb/plumb.hpp"
#include "step/breaks/numbers.hpp"
#include "support/edited_worlds.hpp"
#include "support/figures.hpp"
#include "support/snapshots.hpp"

namespace plumb::PLUMB_TEST_FILE {
namespace {

using test::add_crate;
using test::add_rope;
using test::crate;
using test::expect_refusal;
using test::figure;
using test::for_jointed_settings;
using test::snapshot_of;

constexpr double frame = 1.0 / 60;

/// A rope and a crate over a floor.
Scene several() {
  Scene scene = test::floor_alone();
  add_rope(scene, {0, 1, 0}, {1, 0, 0}, true, 0.02);
  add_crate(scene, {2, 1, 0});
  return scene;
}

Scene rope(double x) {
  Scene scene;
  add_rope(scene, {x, 1, 0}, {0, 0, 1}, true, 0.02);
  return scene;
}

void step(World& world, int times) {
  for (int i = 0; i < times; ++i) world.step(frame);
}

TEST(Numbers, AreReservedAtTheEnd) {
  detail::Numbers numbers(3);
  numbers.reserve(0);
  EXPECT_EQ(numbers, detail::Numbers(3));
  numbers.reserve(2);
  EXPECT_EQ(numbers.count(), 5u);
  EXPECT_TRUE(numbers.has(2));
  EXPECT_FALSE(numbers.has(3));
  EXPECT_EQ(numbers.generation(4), 0u);
  EXPECT_EQ(numbers.find(2), 3u);
  EXPECT_EQ(numbers.find(4), 3u) << "the last may be new";
  numbers.take(3, 1);
  EXPECT_TRUE(numbers.is_first(3));
  numbers.give_back(std::vector<std::uint32_t>{3});
  numbers.reserve(1);
  EXPECT_EQ(numbers.count(), 6u);
  EXPECT_EQ(numbers.find(3), 3u) << "they are one range";
}

// What is edited gets the same numbers, and moves alike to the bit.
TEST(Reserving, ChangesNothingButWhereRoomIs) {
  for_jointed_settings([](const Settings& settings) {
    World world(several(), settings), other(several(), settings);
    world.reserve(rope(0), 3);
    world.reserve(crate({}), 2);
    EXPECT_EQ(world.particle_count(), other.particle_count() + 3 * 5 + 2 * 4);
    EXPECT_EQ(world.rod_count(), other.rod_count() + 3 * 4 + 2 * 6);
    EXPECT_EQ(world.body_count(), 3u);
    EXPECT_EQ(world.info().islands, other.info().islands);
    const std::uint32_t particles = world.particle_count(), rods = world.rod_count();
    for (World* const each : {&world, &other}) {
      step(*each, 3);
      each->add(rope(4));
      each->add(crate({6, 1, 0}));
      each->cut(1);
      step(*each, 3);
      each->join({.a = 4, .b = 13});
      step(*each, 10);
    }
    EXPECT_EQ(world.state_hash(), other.state_hash());
    EXPECT_EQ(world.pose(1).position, other.pose(1).position);
    EXPECT_EQ(world.particle_count(), particles);
    EXPECT_EQ(world.rod_count(), rods);
    std::vector<Vec3> at(particles);
    std::vector<Pose> poses(3);
    world.copy_positions(at);
    world.copy_poses(poses);
    EXPECT_EQ(at[particles - 1], Vec3{});
    EXPECT_EQ(poses[2].position, Pose{}.position);
    EXPECT_EQ(world.scene().particles.size(), other.scene().particles.size());
  });
}

TEST(Reserving, KeepsNumbersFromBeingRead) {
  World world(several(), {.tensions = true});
  const std::uint32_t particle = world.particle_count(), rod = world.rod_count();
  world.reserve(figure({}));
  EXPECT_FALSE(world.handle<Particle>(particle));
  EXPECT_FALSE(world.has_shape({ShapeKind::capsule, 4}));
  expect_refusal("particle 9: is reserved, and not added yet", [&] { (void)world.position(particle); });
  expect_refusal("rod 10: is reserved, and not added yet", [&] { (void)world.tension(rod); });
  expect_refusal("body 1: is reserved, and not added yet", [&] { (void)world.pose(1); });
  expect_refusal("pin 0: is reserved, and not added yet", [&] { (void)world.pin_force(0); });
  expect_refusal("body 3: unknown, the world has 3 bodies", [&] { (void)world.pose(3); });
  step(world, 2);
  EXPECT_TRUE(world.problems().empty());
}

TEST(Reserving, LastsInSnapshotsAndUnderOtherSettings) {
  for_jointed_settings([](Settings settings) {
    World world(several(), settings), late(several(), settings), bare(several(), settings);
    world.reserve(figure({}), 2);
    const std::uint32_t particles = world.particle_count();
    step(world, 3);
    const test::Snapshot empty = snapshot_of(world);
    world.add(figure({4, 2, 0}));
    step(world, 3);
    late.restore(snapshot_of(world));
    EXPECT_EQ(late.particle_count(), particles);
    EXPECT_EQ(late.body_count(), 5u);
    EXPECT_EQ(snapshot_of(late), snapshot_of(world));
    for (World* const each : {&world, &late}) step(*each, 3);
    EXPECT_EQ(late.state_hash(), world.state_hash());
    settings.substeps = 2;
    settings.tensions = false;
    world.set_settings(settings);
    EXPECT_EQ(world.particle_count(), particles);
    late.restore(empty);
    EXPECT_EQ(late.particle_count(), particles);
    EXPECT_FALSE(late.handle<Body>(2));
    late.restore(snapshot_of(bare));
    EXPECT_EQ(late.particle_count(), 9u);
  });
}

TEST(Reserving, IsSeenByQueriesThatBeganBefore) {
  const Scene scene = several();
  World world(scene, {});
  Queries queries(scene, {.rod_radius = 0.01, .particle_radius = 0.01});
  world.reserve(crate({}), 4);
  world.add(crate({8, 1, 0}));
  queries.update(world);
  EXPECT_EQ(queries.cast_ray({.origin = {8, 5, 0}, .direction = {0, -1, 0}, .length = 10}).target,
            (QueryTarget{QueryTarget::Kind::shape, ShapeKind::hull, 1}));
  const Hit hit = queries.cast_ray({.origin = {0, 9, 0.5}, .direction = {0, 0, 1}, .length = 1});
  EXPECT_FALSE(hit) << "nothing reserved is anywhere";
}

TEST(Reserving, IsRefusedWithAReason) {
  World world(several(), {});
  Scene many;
  many.particles.resize(1000);
  expect_refusal("reserve: 1000 of a kind cannot be there 4294967295 times more",
                 [&] { world.reserve(many, 4294967295u); });
  expect_refusal("particles", [&] { world.reserve(many, 2'000'000); });
  EXPECT_EQ(world.particle_count(), 9u);
}

}  // namespace
}  // namespace plumb::PLUMB_TEST_FILE
