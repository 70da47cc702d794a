// Worlds whose islands are laid side by side again after edits.

#include <gtest/gtest.h>

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <string>
#include <tuple>
#include <utility>
#include <vector>

#include "plumb/plumb.hpp"
#include "support/edited_worlds.hpp"
#include "support/snapshots.hpp"
#include "support/worlds.hpp"

namespace plumb::PLUMB_TEST_FILE {
namespace {

using test::expect_refusal;
using test::for_methods;

constexpr double frame = 1.0 / 60;
constexpr std::uint32_t rods = 6;

/// Appends a rope that hangs level from its first particle, along z so that none meets another.
void append_rope(Scene& scene, double x, bool has_capsules) {
  const auto first = static_cast<std::uint32_t>(scene.particles.size());
  for (std::uint32_t i = 0; i <= rods; ++i)
    scene.particles.push_back({.position = {x, 1, 0.1 * i}, .mass = 0.2, .fixed = i == 0});
  for (std::uint32_t i = first; i < first + rods; ++i) {
    scene.rods.push_back({.a = i, .b = i + 1, .length = 0.1});
    if (has_capsules) scene.capsules.push_back({.a = point_at(i), .b = point_at(i + 1), .radius = 0.02});
  }
}

Scene rope(double x, bool has_capsules = false) {
  Scene scene;
  append_rope(scene, x, has_capsules);
  return scene;
}

/// Returns `count` ropes that are apart as one scene.
Scene ropes(std::uint32_t count) {
  Scene scene;
  for (std::uint32_t i = 0; i < count; ++i) append_rope(scene, 0.5 * i, false);
  return scene;
}

Scene floor_alone() {
  Scene scene;
  scene.planes.push_back({.normal = {0, 1, 0}, .offset = 0});
  return scene;
}

void step(World& world, int times) {
  for (int i = 0; i < times; ++i) world.step(frame);
}

using Block = std::tuple<std::string, std::string, std::uint32_t, std::uint32_t>;
/// Lists what lies side by side, in an order of its own.
std::vector<Block> blocks_of(World& world) {
  std::vector<Block> out;
  for (const BlockInfo& each : world.info().blocks)
    out.emplace_back(each.shape, each.layout, each.islands, each.colors);
  std::sort(out.begin(), out.end());
  return out;
}

// Ropes that came one by one lie as in a world that began with them, and nothing jumps.
TEST(Packing, LaysIslandsAsAStartDoes) {
  constexpr std::uint32_t count = 20;
  const Scene whole = ropes(count);
  for_methods([&](const Settings& settings) {
    World world(rope(0), settings), other(rope(0), settings), begun(whole, settings);
    for (World* const each : {&world, &other})
      for (std::uint32_t i = 1; i < count; ++i) {
        each->add(rope(0.5 * i));
        if (i % 5 == 0) each->step(frame);
      }
    const std::vector<Vec3> before = test::positions_of(world);
    world.pack();
    EXPECT_EQ(test::positions_of(world), before);
    step(world, 1);
    step(other, 1);
    EXPECT_EQ(blocks_of(world), blocks_of(begun));
    EXPECT_EQ(world.info().islands, count);
    EXPECT_EQ(world.info().relaxed_rods, begun.info().relaxed_rods);
    // Gradient new and, relaxed, old make displacements of velocities, as they do in other edits.
    const bool is_rough = settings.gradient == Gradient::new_ ||
                          (settings.method == Method::relax && settings.gradient == Gradient::old);
    const double most = settings.precision == Precision::single || is_rough ? 2e-5 : 1e-11;
    EXPECT_LE(test::apart(world, other), most);
    step(world, 10);
    step(other, 10);
    EXPECT_LE(test::apart(world, other), 100 * most);
  });
}

// All that programs had ordered goes on: forces, grabs, winches, cuts in the same step, capsules and joints.
TEST(Packing, KeepsWhatWasOrdered) {
  for (const Method method : {Method::automatic, Method::direct, Method::relax}) {
    SCOPED_TRACE(to_string(method));
    Settings settings{.method = method, .gradient = Gradient::mid, .substeps = 8, .tensions = true};
    if (method == Method::relax) settings.stop.sweeps = 200;
    World packed(floor_alone(), settings), other(floor_alone(), settings);
    std::vector<Handle<Grab>> grabs;
    for (World* const world : {&packed, &other}) {
      for (std::uint32_t i = 0; i < 6; ++i) world->add(rope(0.5 * i, i % 2 == 0));
      Scene crate;
      const std::uint32_t body = add_body(
          crate, {.mass = 1, .center = {-1, 0.1, 0}, .inertia = {.xx = 0.01, .yy = 0.01, .zz = 0.01}});
      crate.hulls.push_back(box_on_body(body, {.center = {-1, 0.1, 0}, .half_size = {0.1, 0.1, 0.1}}));
      world->add(crate);
      step(*world, 5);
      world->set_force(rods, {0.5, 0, 0});
      grabs.push_back(world->grab(Grab::particle(2 * rods + 1, {0.6, 1, 0.6}, 20)));
      if (method != Method::relax) world->set_length(2 * rods, 0.11);  // it damps ropes beside it
      world->cut(4 * rods + 3);
    }
    packed.pack();
    step(packed, 1);
    step(other, 1);
    EXPECT_LE(test::apart(packed, other), 1e-9);
    for (int i = 0; i < 20; ++i)
      for (World* const world : {&packed, &other}) {
        if (method != Method::relax) world->set_length(2 * rods, 0.11 + 0.001 * i);
        world->step(frame);
      }
    EXPECT_LE(test::apart(packed, other), 1e-6);
    EXPECT_TRUE(packed.has(grabs[0]));
    EXPECT_TRUE(packed.is_broken(4 * rods + 3));
    EXPECT_NEAR(packed.tension(2 * rods), other.tension(2 * rods), 1e-4);
    EXPECT_EQ(packed.info().islands, other.info().islands);
  }
}

TEST(Packing, IsPartOfSnapshotsAndOtherSettings) {
  for (const unsigned threads : {1u, 2u}) {
    const Settings settings{.substeps = 4, .threads = threads};
    World world(floor_alone(), settings);
    for (std::uint32_t i = 0; i < 9; ++i) world.add(rope(0.5 * i, i % 3 == 0));
    step(world, 3);
    world.pack();
    world.pack();
    std::vector<std::byte> waiting(world.snapshot_size());
    world.save(waiting);
    step(world, 3);
    std::vector<std::byte> packed(world.snapshot_size());
    world.save(packed);
    const std::uint64_t hash = world.state_hash();
    World fresh(floor_alone(), settings);
    fresh.restore(waiting);
    step(fresh, 3);
    EXPECT_EQ(fresh.state_hash(), hash);
    fresh.restore(packed);
    EXPECT_EQ(fresh.state_hash(), hash);
    step(world, 5);
    step(fresh, 5);
    EXPECT_EQ(fresh.state_hash(), world.state_hash());
    Settings relaxed = settings;
    relaxed.method = Method::relax;
    relaxed.stop.sweeps = 50;
    world.set_settings(relaxed);
    step(world, 3);
    world.remove(3);
    world.pack();
    step(world, 3);
    EXPECT_EQ(world.info().islands, 8u);
  }
}

// What a program loads one by one before it steps lies as what it loads at once, and moves as it would alone.
TEST(Arrivals, LieSideBySide) {
  constexpr std::uint32_t count = 20;
  for_methods([&](const Settings& settings) {
    World world(Scene{}, settings), begun(ropes(count), settings), alone(rope(0.5 * (count - 1)), settings);
    for (std::uint32_t i = 0; i < count; ++i) world.add(rope(0.5 * i));
    step(world, 1);
    step(alone, 1);
    EXPECT_EQ(blocks_of(world), blocks_of(begun));
    EXPECT_EQ(world.info().islands, count);
    const double most = settings.precision == Precision::single ? 1e-5 : 1e-11;
    for (std::uint32_t i = 0; i <= rods; ++i)
      EXPECT_LE(norm(world.position((count - 1) * (rods + 1) + i) - alone.position(i)), most);
  });
}

TEST(Arrivals, OfOneStepAlone) {
  Settings settings{.method = Method::relax};
  settings.stop.sweeps = 5;
  World world(Scene{}, settings);
  const auto blocks_that_step = [&] { return world.step(frame).block_sweeps / 5; };
  for (std::uint32_t i = 0; i < 12; ++i) {
    world.add(rope(0.5 * i));
    if (i % 3 != 2) continue;
    EXPECT_EQ(blocks_that_step(), i + 1);  // three at a time gain too little
  }
  for (std::uint32_t i = 12; i < 17; ++i) world.add(rope(0.5 * i));
  world.remove(12 * (rods + 1) + 1);
  EXPECT_EQ(blocks_that_step(), 13u);  // the four that are left share a block
  world.add(ropes(4));
  EXPECT_EQ(blocks_that_step(), 14u);
  for (std::uint32_t i = 0; i < 4; ++i) world.add(rope(0.5 * i));
  world.cut(3);
  EXPECT_EQ(blocks_that_step(), 16u);  // one for them, and one for either end of what was cut
}

// What was there keeps its bits, what was ordered goes on, and a snapshot between knows what is to come.
TEST(Arrivals, LeaveOthersAlone) {
  for (const Method method : {Method::automatic, Method::direct, Method::relax}) {
    SCOPED_TRACE(to_string(method));
    Settings settings{.method = method, .tensions = true};
    if (method == Method::relax) settings.stop.sweeps = 50;
    Scene begin = rope(-1, true);
    begin.planes.push_back({.normal = {0, 1, 0}, .offset = 0});
    World world(begin, settings), without(begin, settings), restored(begin, settings);
    for (World* const each : {&world, &without}) step(*each, 7);
    for (std::uint32_t i = 0; i < 8; ++i) world.add(rope(0.5 * i, i % 2 == 0));
    const std::uint32_t first = rods + 1, last = first + 7 * (rods + 1);
    world.set_force(last + rods, {0.5, 0, 0});
    const Handle<Grab> grab = world.grab(Grab::particle(first + rods, {0.1, 1, 0.6}, 20));
    world.cut(rods + rods / 2);
    std::vector<std::byte> waiting(world.snapshot_size());
    world.save(waiting);
    restored.restore(waiting);
    for (World* const each : {&world, &without, &restored}) step(*each, 9);
    EXPECT_EQ(restored.state_hash(), world.state_hash());
    for (std::uint32_t i = 0; i <= rods; ++i) EXPECT_EQ(world.position(i), without.position(i));
    EXPECT_TRUE(world.has(grab));
    EXPECT_TRUE(world.is_broken(rods + rods / 2));
    EXPECT_GT(world.position(last + rods).x, 3.5 + 1e-3);  // pushed by half its weight from x = 3.5
    EXPECT_NEAR(world.position(last - 1).x, 3, 1e-6);
  }
}

// Ropes that fill their lanes keep their bits, and who packs again without an edit between does nothing.
TEST(Packing, LeavesWhatLiesWell) {
  constexpr std::uint32_t begun = 32, added = 20;
  for_methods([&](const Settings& settings) {
    World world(ropes(begun), settings), other(ropes(begun), settings);
    for (std::uint32_t i = 0; i < added; ++i)
      for (World* const each : {&world, &other}) {
        each->add(rope(-0.5 * (i + 1)));
        each->step(frame);
      }
    world.pack();
    step(world, 1);
    step(other, 1);
    for (std::uint32_t i = 0; i < begun * (rods + 1); ++i) EXPECT_EQ(world.position(i), other.position(i));
    if (settings.method == Method::relax) {
      EXPECT_NE(blocks_of(world), blocks_of(other));
    }
    const std::uint64_t packed = world.snapshot_size(), hash = [&] {
      other.restore(test::snapshot_of(world));
      step(other, 1);
      return other.state_hash();
    }();
    world.pack();
    step(world, 1);
    EXPECT_EQ(world.snapshot_size(), packed);
    EXPECT_EQ(world.state_hash(), hash);
  });
}

TEST(Packing, IsRefusedWhereNothingIsEdited) {
  World world(rope(0), {.method = Method::springs});
  expect_refusal("method springs packs no world", [&] { world.pack(); });
}

}  // namespace
}  // namespace plumb::PLUMB_TEST_FILE
