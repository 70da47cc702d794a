// Settings that change while a world runs: what stays, what is refused, and what snapshots fit to.

#include "support/changed_settings.hpp"

#include <gtest/gtest.h>

#include <cstddef>
#include <cstdint>
#include <string>
#include <utility>
#include <vector>

#include "plumb/plumb.hpp"
#include "support/edited_worlds.hpp"
#include "support/snapshots.hpp"
#include "support/worlds.hpp"

namespace plumb::PLUMB_TEST_FILE {
namespace {

using test::apart;
using test::expect_refusal;
using test::for_changes;
using test::methods;
using test::motion_of;
using test::settings_of;
using test::snapshot_of;

constexpr double frame = 1.0 / 60;
TEST(ChangedSettings, KeepMotionBitForBitWhereStorageIsTheSame) {
  for (const Scene& scene : {test::swinging(), test::touching()})
    for_changes([&](const Settings& before, const Settings& after) {
      World world(scene, before);
      test::run(world, frame, 20);
      const test::Motion motion = motion_of(world);
      const double time = world.time();
      world.set_settings(after);
      EXPECT_EQ(motion_of(world), motion);
      EXPECT_EQ(world.time(), time);
      EXPECT_EQ(world.settings().method, after.method);
      test::run(world, frame, 20);
      EXPECT_TRUE(test::all_finite(world));
      EXPECT_NE(motion_of(world), motion);
    });
}

TEST(ChangedSettings, KeepMotionToTheRoundingOfStorage) {
  const Scene scene = test::swinging();
  for (const Method method : methods) {
    Settings settings = settings_of(method);
    World world(scene, settings);
    test::run(world, frame, 20);
    const test::Motion motion = motion_of(world);
    settings.precision = Precision::single;
    world.set_settings(settings);
    for (std::uint32_t i = 0; i < world.particle_count(); ++i) {
      EXPECT_LE(norm(world.position(i) - motion.positions[i]), 1e-6);
      EXPECT_LE(norm(world.velocity(i) - motion.velocities[i]), 1e-6);
    }
    const test::Motion single = motion_of(world);
    settings.precision = Precision::double_;
    world.set_settings(settings);
    EXPECT_EQ(motion_of(world), single);
  }
}

TEST(ChangedSettings, LeaveBitsAsTheyAreWhereTheySayOnlyWhoWorks) {
  for (const Scene& scene : {test::swinging(), test::touching()})
    for (const Method method : methods) {
      Settings settings = settings_of(method);
      settings.tensions = true;
      World world(scene, settings), same(scene, settings);
      for (int i = 0; i < 60; ++i) {
        if (i % 10 == 5) {
          settings.threads = 3 - settings.threads;
          settings.isa = i % 20 == 5 ? Isa::scalar : best_isa();
          world.set_settings(settings);
        }
        world.step(frame);
        same.step(frame);
        ASSERT_EQ(world.state_hash(), same.state_hash()) << i;
      }
      for (std::uint32_t rod = 0; rod < world.rod_count(); ++rod)
        EXPECT_EQ(world.tension(rod), same.tension(rod));
    }
}

TEST(ChangedSettings, MayBeThoseThatTheWorldShows) {
  World world(test::swinging(), settings_of(Method::direct)),
      twin(test::swinging(), settings_of(Method::direct));
  test::run(world, frame, 5);
  test::run(twin, frame, 5);
  world.set_settings(world.settings());
  test::run(world, frame, 5);
  test::run(twin, frame, 5);
  EXPECT_EQ(world.state_hash(), twin.state_hash());
  EXPECT_EQ(snapshot_of(world), snapshot_of(twin));
}

TEST(ChangedSettings, DoWhatTheirOwnFunctionsDo) {
  const Scene scene = test::swinging();
  Settings settings = settings_of(Method::relax);
  World world(scene, settings), other(scene, settings);
  for (World* each : {&world, &other}) test::run(*each, frame, 10);
  settings.substeps = 7;
  settings.stop.sweeps = 9;
  settings.weights = Weights::equal;
  world.set_settings(settings);
  other.set_substeps(7);
  other.set_stop_rule(settings.stop);
  other.set_weights(Weights::equal);
  for (World* each : {&world, &other}) EXPECT_EQ(each->step(frame).substeps, 7u);
  EXPECT_EQ(world.state_hash(), other.state_hash());
  EXPECT_EQ(other.settings().substeps, 7u);
  EXPECT_EQ(other.settings().weights, Weights::equal);
}

TEST(ChangedSettings, KeepWhatProgramsOrdered) {
  Scene scene = test::swinging();
  const std::uint32_t anchor = 0, tip = 6, other_tip = 13;
  for_changes([&](const Settings& before, const Settings& after) {
    // The other world never changes, so that orders show in what it does too.
    World world(scene, before), other(scene, after);
    for (World* each : {&world, &other}) {
      each->step(frame);
      each->set_force(tip, {0, 0, 3});
      each->set_gravity({0, -1, 0});
    }
    world.step(frame);
    const auto grab =
        world.grab(Grab::particle(other_tip, world.position(other_tip) + Vec3{0, 0.2, 0}, 50, 1));
    world.move_anchor(anchor, {0, 0.1, 0});
    world.cut(8);
    world.fix(3);
    int asked = 0;
    world.set_load([&](const LoadState&, std::span<Vec3>) { ++asked; });
    const double before_change = world.velocity(tip).z;
    world.set_settings(after);
    EXPECT_TRUE(world.has(grab));
    EXPECT_TRUE(world.is_broken(8));
    expect_refusal("is fixed", [&] { world.set_force(3, {}); });
    test::run(world, frame, 10);
    EXPECT_EQ(asked, 10);
    EXPECT_EQ(world.position(anchor), (Vec3{0, 0.1, 0}));
    EXPECT_GE(world.velocity(tip).z, before_change + 0.3);
    EXPECT_EQ(world.velocity(3), Vec3{});
    EXPECT_NE(world.position(other_tip), scene.particles[other_tip].position);
  });
}

TEST(ChangedSettings, ComeBetweenEdits) {
  Scene scene = test::swinging();
  scene.rods[2].law.strength = 1;  // which breaks as its rope falls
  for_changes([&](const Settings& before, const Settings& after) {
    World world(scene, before);
    int broke_at = 0;
    for (int i = 1; i <= 60 && broke_at == 0; ++i)
      if (world.step(frame).broken_rods > 0) broke_at = i;
    ASSERT_GT(broke_at, 0);
    const auto rope = [] {
      Scene out;
      test::add_rope(out, {0, 4, 0}, {1, 0, 0}, 4, true);
      return out;
    }();
    world.set_settings(after);
    EXPECT_TRUE(world.is_broken(2));
    const Added added = world.add(rope);
    const Handle<Particle> handle = world.handle<Particle>(added.particle + 4);
    world.cut(7);
    world.step(frame);
    world.set_settings(before);
    world.remove(15);
    world.set_settings(after);
    EXPECT_FALSE(world.handle<Particle>(15));
    const Added again = world.add(rope);
    world.step(frame);
    const test::Motion motion = motion_of(world);
    world.set_settings(before);
    EXPECT_EQ(motion_of(world), motion);
    EXPECT_EQ(world.number(handle), added.particle + 4);
    EXPECT_TRUE(world.is_broken(7));
    test::run(world, frame, 10);
    EXPECT_TRUE(test::all_finite(world));
    EXPECT_NEAR(norm(world.position(again.particle + 1) - world.position(again.particle)), 0.1, 1e-3);
    // What broke and what was cut is apart, and what is whole is not.
    EXPECT_GE(norm(world.position(3) - world.position(2)), 0.11);
    EXPECT_NEAR(norm(world.position(1) - world.position(0)), 0.1, 1e-3);
  });
}

TEST(ChangedSettings, LetWhatSleepsSleepOn) {
  Scene scene = test::touching();
  const std::uint32_t hanging = test::add_rope(scene, {5, 1, 0}, {0, -1, 0}, 4, true);
  for_changes([&](Settings before, Settings after) {
    before.contacts = after.contacts = before.events = after.events = true;
    World world(scene, before);
    std::uint32_t awake = 9;
    for (int i = 0; i < 1200 && awake > 1; ++i) awake = world.step(frame).awake_islands;
    ASSERT_LE(awake, 1u);  // the spring swings for long under relax
    const std::size_t contacts = world.contacts().size();
    ASSERT_GE(contacts, 2u);
    const test::Motion motion = motion_of(world);
    world.set_settings(after);
    EXPECT_EQ(motion_of(world), motion);
    EXPECT_EQ(world.contacts().size(), contacts);
    // A rope that sweeps left off its length wakes where it is solved. What touches sleeps on.
    const bool was_swept = before.method == Method::relax;
    EXPECT_LE(world.step(frame).awake_islands, awake + (was_swept ? 1 : 0));
    for (const Event& event : world.events())
      EXPECT_TRUE(event.kind != Event::Kind::woke || (was_swept && event.particle > hanging));
    for (const Contact& contact : world.contacts()) EXPECT_NE(contact.phase, ContactPhase::ended);
    after.sleep = false;
    world.set_settings(after);
    EXPECT_GE(world.step(frame).awake_islands, 4u);
    EXPECT_LE(apart(world, World(scene, before)), 3);
  });
}

/// Names the pairs that touch, with what they push in N s.
std::vector<std::pair<std::pair<ShapeId, ShapeId>, Vec3>> pairs_of(const World& world) {
  std::vector<std::pair<std::pair<ShapeId, ShapeId>, Vec3>> out;
  for (const Contact& each : world.contacts()) {
    EXPECT_EQ(each.phase, ContactPhase::persisted);
    out.push_back({{each.a, each.b}, each.impulse});
  }
  return out;
}

// What was removed left its number of an island free, which the changed world does not know.
TEST(ChangedSettings, KeepContactsWhereOthersWereRemoved) {
  for_changes([&](Settings before, Settings after) {
    for (Settings* const each : {&before, &after}) each->contacts = each->tensions = true;
    World world(test::touching(), before);
    const auto add = [&](Vec3 from) {
      Scene rope;
      test::add_rope(rope, from, {0, 0, 1}, 4, false);
      for (std::uint32_t i = 0; i < 4; ++i)
        rope.capsules.push_back({.a = point_at(i), .b = point_at(i + 1), .radius = 0.02});
      return world.add(rope).particle;
    };
    const std::uint32_t gone = add({5, 0.02, 0});
    add({0.12, 0.06, -0.2});  // across the first rope
    test::run(world, frame, 2);
    world.remove(gone);
    std::uint32_t awake = 9;
    for (int i = 0; i < 1200 && awake > 1; ++i) awake = world.step(frame).awake_islands;
    ASSERT_LE(awake, 1u);
    const auto pairs = pairs_of(world);
    ASSERT_GE(pairs.size(), 12u);
    const Vec3 weight = world.contact_force({ShapeKind::plane, 0});
    EXPECT_LE(weight.y, -15);
    world.set_settings(after);
    EXPECT_EQ(pairs_of(world), pairs);
    EXPECT_EQ(world.contact_force({ShapeKind::plane, 0}), weight);
    world.step(frame);
    EXPECT_EQ(pairs_of(world), pairs);
    EXPECT_LE(norm(world.contact_force({ShapeKind::plane, 0}) - weight), 1e-12);
  });
}

TEST(ChangedSettings, AreRefusedBeforeAnythingChanges) {
  register_reference_methods();
  Scene scene = test::swinging();
  World world(scene, settings_of(Method::direct));
  test::run(world, frame, 5);
  world.cut(3);
  const std::uint64_t hash = world.state_hash();
  const test::Snapshot snapshot = snapshot_of(world);
  const auto refuses = [&](const std::string& why, const Settings& settings) {
    expect_refusal(why, [&] { world.set_settings(settings); });
    EXPECT_EQ(world.state_hash(), hash);
    EXPECT_EQ(snapshot_of(world), snapshot);
    EXPECT_EQ(world.settings().method, Method::direct);
  };
  refuses("omega must be", {.omega = 3});
  refuses("takes more than most_memory, 10 bytes", {.most_memory = 10});
  refuses("substeps must be", {.substeps = 0});
  refuses("does not read weights", {.method = Method::direct, .weights = Weights::equal});
  refuses("mass consistent needs", {.method = Method::relax, .mass = MassModel::consistent});
  for (const Method method : {Method::springs, Method::multipliers, Method::featherstone})
    refuses("keeps a state of its own", {.method = method});
  World springs(scene, {.method = Method::springs});
  expect_refusal("method springs, that of now", [&] { springs.set_settings(settings_of(Method::direct)); });
}

TEST(ChangedSettings, AreRefusedWhereStateHasNoPlace) {
  Scene scene;
  test::add_rope(scene, {0, 0, 0}, {1, 0, 0}, 6, true);
  scene.particles[1].fixed = true;
  scene.rods.erase(scene.rods.begin());
  for (std::uint32_t i = 1; i < 6; ++i)
    scene.bends.push_back({.a = i - 1, .b = i, .c = i + 1, .stiffness = 1});
  scene.twists.push_back({.particles = {0, 1, 2, 3, 4, 5, 6}, .stiffness = 1});
  Settings settings = settings_of(Method::direct);
  World world(scene, settings), same(scene, settings);
  for (World* each : {&world, &same}) {
    each->set_twist(0, 2);
    test::run(*each, frame, 5);
  }
  settings.gradient = Gradient::new_;
  expect_refusal("twist 0 has a past", [&] { world.set_settings(settings); });
  settings.gradient.reset();
  settings.threads = 2;
  world.set_settings(settings);
  for (World* each : {&world, &same}) test::run(*each, frame, 5);
  EXPECT_EQ(world.state_hash(), same.state_hash());
  EXPECT_EQ(world.twist(0), same.twist(0));
}

// A rod that is cut falls out where its mass lies in its ends, and joins them still where it lies along it.
// What was removed with one of them is the whole rope there.
TEST(ChangedSettings, AreRefusedWherePiecesThatWentWereNone) {
  Scene scene;
  test::add_rope(scene, {0, 0, 0}, {1, 0, 0}, 6, false);
  for (Rod& rod : scene.rods) rod.mass = 0.1;
  Settings settings = settings_of(Method::relax);
  World world(scene, settings);
  world.cut(2);
  test::run(world, frame, 1);
  world.remove(5);
  test::run(world, frame, 1);
  const std::uint64_t hash = world.state_hash();
  settings = settings_of(Method::direct);
  expect_refusal("particle 0: mass model consistent has it in another island than that which was removed",
                 [&] { world.set_settings(settings); });
  EXPECT_EQ(world.state_hash(), hash);
  settings.mass = MassModel::lumped;
  world.set_settings(settings);
  test::run(world, frame, 1);
  EXPECT_TRUE(world.handle<Particle>(0));

  World joined(scene, settings_of(Method::direct));
  joined.fix(3);
  joined.cut(3);
  test::run(joined, frame, 1);
  joined.remove(0);
  EXPECT_TRUE(joined.handle<Particle>(3)) << "the mass of the rod hangs from it";
  test::run(joined, frame, 1);
  expect_refusal("rod 3: mass model lumped has it in another island than that which was removed",
                 [&] { joined.set_settings(settings_of(Method::relax)); });
}

TEST(ChangedSettings, SayWhatSnapshotsFitTo) {
  for (const Scene& scene : {test::swinging(), test::touching()})
    for_changes([&](const Settings& before, const Settings& after) {
      World world(scene, before);
      test::run(world, frame, 10);
      world.cut(1);
      world.step(frame);
      const test::Snapshot old = snapshot_of(world);
      world.set_settings(after);
      expect_refusal("other settings", [&] { world.restore(old); });
      const test::Snapshot changed = snapshot_of(world);
      World twin(scene, after);
      twin.restore(changed);
      EXPECT_EQ(motion_of(twin), motion_of(world));
      for (World* each : {&world, &twin}) test::run(*each, frame, 3);
      EXPECT_EQ(twin.state_hash(), world.state_hash());
      world.restore(changed);
      test::run(world, frame, 3);
      EXPECT_EQ(twin.state_hash(), world.state_hash());
      world.set_settings(before);
      World(scene, before).restore(snapshot_of(world));
    });
}

}  // namespace
}  // namespace plumb::PLUMB_TEST_FILE
