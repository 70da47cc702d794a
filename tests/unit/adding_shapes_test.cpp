// Ropes with capsules that are added to a world while it runs, and removed.

#include <gtest/gtest.h>

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

#include "contact/edits/given_numbers.hpp"
#include "plumb/plumb.hpp"
#include "support/edited_worlds.hpp"
#include "support/figures.hpp"
#include "support/worlds.hpp"

namespace plumb::PLUMB_TEST_FILE {
namespace {

using test::expect_refusal;
using test::floor_alone;

constexpr double frame = 1.0 / 60, radius = 0.02;

/// Appends a rope of four rods of 0.1 m with capsules along them.
void add_rope(Scene& scene, Vec3 from, Vec3 way, bool is_anchored = false) {
  test::add_rope(scene, from, way, is_anchored, radius);
}

Scene rope(Vec3 from, Vec3 way, bool is_anchored = false) {
  Scene scene;
  add_rope(scene, from, way, is_anchored);
  return scene;
}

template <class F>
void for_settings(F&& f) {
  for (const Method method : {Method::automatic, Method::direct, Method::relax})
    for (const unsigned threads : {1u, 2u}) {
      SCOPED_TRACE(std::string(to_string(method)) + " " + std::to_string(threads));
      Settings settings{.method = method, .substeps = 4, .tensions = true, .threads = threads};
      settings.contacts = true;
      if (method == Method::relax) settings.stop.sweeps = 30;
      f(settings);
    }
}

void expect_alike(const World& one, const World& other) {
  ASSERT_EQ(one.particle_count(), other.particle_count());
  for (std::uint32_t i = 0; i < one.particle_count(); ++i) {
    EXPECT_EQ(one.position(i), other.position(i)) << i;
    EXPECT_EQ(one.velocity(i), other.velocity(i)) << i;
  }
}

TEST(GivenNumbers, AreGivenOrTheLowestThatAreFree) {
  detail::GivenNumbers numbers;
  numbers.give({});
  EXPECT_EQ(numbers.take(2), 2u);
  numbers.end(1);
  EXPECT_EQ(numbers.take(3), 3u) << "places still name 1";
  EXPECT_EQ(numbers.made(), (Array<std::uint32_t>{2, 3}));
  numbers.give({});
  EXPECT_EQ(numbers.take(4), 1u);
  numbers.give(std::vector<std::uint32_t>{6, 5});
  EXPECT_EQ(numbers.take(4), 6u);
  EXPECT_EQ(numbers.take(7), 5u);
  EXPECT_EQ(numbers.take(7), 4u);
}

// Two ropes that are added one by one fall on the floor and on each other as if the world began with them.
TEST(AddingShapes, DoAsTheyWouldFromTheStart) {
  Scene whole = floor_alone();
  add_rope(whole, {0, 0.1, 0}, {1, 0, 0});
  add_rope(whole, {0.2, 0.3, -0.2}, {0, 0, 1});
  for_settings([&](const Settings& settings) {
    World begun(whole, settings), grown(floor_alone(), settings);
    EXPECT_EQ(grown.add(rope({0, 0.1, 0}, {1, 0, 0})).capsule, 0u);
    EXPECT_EQ(grown.add(rope({0.2, 0.3, -0.2}, {0, 0, 1})).capsule, 4u);
    for (int i = 0; i < 60; ++i) {
      begun.step(frame);
      grown.step(frame);
      expect_alike(begun, grown);
    }
    for (std::uint32_t i = 0; i < 10; ++i) EXPECT_GE(grown.position(i).y, radius - 1e-3);
    ASSERT_EQ(begun.contacts().size(), grown.contacts().size());
    EXPECT_FALSE(grown.contacts().empty());
    for (std::size_t i = 0; i < grown.contacts().size(); ++i) {
      EXPECT_EQ(grown.contacts()[i].a, begun.contacts()[i].a);
      EXPECT_EQ(grown.contacts()[i].b, begun.contacts()[i].b);
    }
  });
}

// Numbers of what is gone go to what comes next, beside hulls, whose numbers lie between.
TEST(AddingShapes, GetTheNumbersOfThoseThatAreGone) {
  Scene scene = floor_alone();
  add_rope(scene, {0, radius, 0}, {1, 0, 0});
  const std::uint32_t body =
      add_body(scene, {.mass = 1, .center = {3, 0.5, 0}, .inertia = {.xx = 0.1, .yy = 0.1, .zz = 0.1}});
  std::vector<Vec3> corners;
  for (int i = 0; i < 8; ++i)
    corners.push_back({i % 2 == 0 ? 2.5 : 3.5, i / 2 % 2 == 0 ? 0.0 : 1.0, i / 4 == 0 ? -0.5 : 0.5});
  scene.hulls.push_back({.body = body, .points = corners});
  World world(scene, {.tensions = true});
  const Added first = world.add(rope({0, 0.5, 1}, {1, 0, 0})),
              second = world.add(rope({0, 0.5, 2}, {1, 0, 0}));
  EXPECT_EQ(first.capsule, 4u);
  EXPECT_EQ(second.capsule, 8u);
  for (int i = 0; i < 90; ++i) world.step(frame);
  const auto pushed = [&](std::uint32_t from) {
    double sum = 0;
    for (std::uint32_t i = from; i < from + 4; ++i) sum += world.contact_force({ShapeKind::capsule, i}).y;
    return sum;
  };
  const double weight = 0.5 * 9.81;
  for (const std::uint32_t from : {0u, 4u, 8u}) EXPECT_NEAR(pushed(from), weight, 0.05 * weight) << from;
  EXPECT_NEAR(world.contact_force({ShapeKind::hull, 0}).y, 9.81, 0.5);

  world.remove(first.particle);
  for (std::uint32_t i = 4; i < 8; ++i) EXPECT_FALSE(world.has_shape({ShapeKind::capsule, i}));
  EXPECT_TRUE(world.has_shape({ShapeKind::capsule, 8}));
  EXPECT_EQ(world.add(rope({0, 0.5, 1}, {1, 0, 0})), first);
  EXPECT_TRUE(world.has_shape({ShapeKind::capsule, 4}));
  world.remove(0);
  EXPECT_EQ(world.add(rope({0, 0.5, 0}, {1, 0, 0})).capsule, 0u);
  for (int i = 0; i < 90; ++i) world.step(frame);
  for (const std::uint32_t from : {0u, 4u, 8u}) EXPECT_NEAR(pushed(from), weight, 0.05 * weight) << from;
}

/// Returns how many pairs are in a phase.
std::ptrdiff_t count_of(const World& world, ContactPhase phase) {
  return std::count_if(world.contacts().begin(), world.contacts().end(),
                       [&](const Contact& each) { return each.phase == phase; });
}

// A pair is of shapes, not of their numbers, which others may have a moment later.
TEST(AddingShapes, BeginContactsOfTheirOwn) {
  for_settings([](const Settings& settings) {
    World world(floor_alone(), settings);
    const Added gone = world.add(rope({0, radius, 0}, {1, 0, 0}));
    for (int i = 0; i < 10; ++i) world.step(frame);
    const std::ptrdiff_t touched = count_of(world, ContactPhase::persisted);
    ASSERT_GE(touched, 2);
    world.remove(gone.particle);
    EXPECT_EQ(world.add(rope({9, radius, 0}, {0, 0, 1})), gone);
    std::vector<std::byte> kept(world.snapshot_size());
    world.save(kept);
    World fresh(floor_alone(), settings);
    fresh.restore(kept);
    for (World* const each : {&world, &fresh}) {
      each->step(frame);
      EXPECT_EQ(count_of(*each, ContactPhase::ended), touched);
      EXPECT_GE(count_of(*each, ContactPhase::began), 2);
      EXPECT_EQ(count_of(*each, ContactPhase::persisted), 0);
    }
    const Contact &first = world.contacts()[0], &second = world.contacts()[1];
    EXPECT_EQ(first.a, second.a);
    EXPECT_EQ(first.phase, ContactPhase::ended);
    EXPECT_LE(first.point.x, 1);
    EXPECT_EQ(second.phase, ContactPhase::began);
    EXPECT_GE(second.point.x, 8);
    world.step(frame);
    EXPECT_EQ(count_of(world, ContactPhase::ended), 0);
  });
}

// Cuts make islands anew, whose shapes are what they were.
TEST(AddingShapes, KeepContactsThroughEdits) {
  for_settings([](const Settings& settings) {
    World world(floor_alone(), settings);
    const Added added = world.add(rope({0, radius, 0}, {1, 0, 0}));
    for (int i = 0; i < 10; ++i) world.step(frame);
    world.cut(added.rod + 1);
    world.pack();
    world.step(frame);
    for (const Contact& each : world.contacts())
      EXPECT_TRUE(each.phase == ContactPhase::persisted || each.a.number == added.capsule + 1);
    EXPECT_GE(count_of(world, ContactPhase::persisted), 2);
  });
}

TEST(AddingShapes, EndContactsWhereNothingIsLeft) {
  World world(floor_alone(), {.tensions = true, .contacts = true});
  const Added added = world.add(rope({0, radius, 0}, {1, 0, 0}));
  for (int i = 0; i < 200; ++i) world.step(frame);
  ASSERT_EQ(world.step(frame).awake_islands, 0u);
  EXPECT_LE(world.contact_force({ShapeKind::plane, 0}).y, -1);
  const std::ptrdiff_t touched = count_of(world, ContactPhase::persisted);
  world.remove(added.particle);
  world.step(frame);
  EXPECT_EQ(count_of(world, ContactPhase::ended), touched);
  EXPECT_EQ(world.contact_force({ShapeKind::plane, 0}), Vec3{});
  world.step(frame);
  EXPECT_TRUE(world.contacts().empty());
}

TEST(AddingShapes, ComeBackWithSnapshots) {
  for_settings([](const Settings& settings) {
    World world(floor_alone(), settings);
    const Added gone = world.add(rope({5, 0.1, 0}, {1, 0, 0}));
    world.add(rope({0, 0.1, 0}, {1, 0, 0}));
    for (int i = 0; i < 10; ++i) world.step(frame);
    world.remove(gone.particle);
    world.add(rope({0.2, 0.3, -0.2}, {0, 0, 1}));
    for (int i = 0; i < 10; ++i) world.step(frame);
    std::vector<std::byte> kept(world.snapshot_size());
    world.save(kept);
    const auto go_on = [](World& of) {
      for (int i = 0; i < 40; ++i) of.step(frame);
      return of.state_hash();
    };
    const std::uint64_t hash = go_on(world);
    World fresh(floor_alone(), settings);
    fresh.restore(kept);
    EXPECT_EQ(go_on(fresh), hash);
    world.remove(5);
    world.restore(kept);
    EXPECT_EQ(go_on(world), hash);
  });
}

// Memory is used again: snapshots after many have come and gone are as large as after few.
TEST(AddingShapes, LeaveNothingOnceTheyAreGone) {
  World world(floor_alone(), {});
  world.add(rope({0, 0.1, 0}, {1, 0, 0}));
  std::size_t size = 0;
  for (int i = 0; i < 20; ++i) {
    const Added added = world.add(rope({1.0 + i, 0.1, 0}, {1, 0, 0}));
    EXPECT_EQ(added.capsule, 4u);
    world.step(frame);
    world.remove(added.particle);
    world.step(frame);
    if (i == 1) size = world.snapshot_size();
  }
  EXPECT_LE(world.snapshot_size(), size + 4096) << "but for contacts";
  std::vector<std::byte> kept(world.snapshot_size());
  world.save(kept);
  World fresh(floor_alone(), {});
  fresh.restore(kept);
  for (World* const each : {&world, &fresh}) each->add(rope({0.2, 0.3, -0.2}, {0, 0, 1}));
  for (int i = 0; i < 40; ++i)
    for (World* const each : {&world, &fresh}) each->step(frame);
  EXPECT_EQ(world.state_hash(), fresh.state_hash());
}

// Edits know them as they know others, and so do other settings.
TEST(AddingShapes, AreCutJoinedAndMovedByOtherSettings) {
  for_settings([](const Settings& settings) {
    Scene scene = floor_alone();
    add_rope(scene, {0, 1, 0}, {0, -1, 0}, true);
    World world(scene, settings);
    const Added added = world.add(rope({0.1, 0.6, 0}, {1, 0, 0}));
    world.step(frame);
    world.join({.a = 4, .b = added.particle, .length = norm(world.position(4) - world.position(5))});
    world.step(frame);
    Settings changed = settings;
    changed.method = settings.method == Method::relax ? Method::direct : Method::relax;
    changed.stop = changed.method == Method::relax ? StopRule{.sweeps = 30} : StopRule{};
    world.set_settings(changed);
    for (int i = 0; i < 60; ++i) world.step(frame);
    EXPECT_GE(world.position(9).y, 0.1) << "it hangs";
    world.cut(added.rod + 1);
    for (int i = 0; i < 90; ++i) world.step(frame);
    EXPECT_LE(world.position(9).y, 0.05) << "it fell";
    EXPECT_GE(world.position(9).y, radius - 2e-3);
    EXPECT_FALSE(world.has_shape({ShapeKind::capsule, added.capsule + 1}));
    EXPECT_TRUE(world.has_shape({ShapeKind::capsule, added.capsule + 2}));
    world.fix(added.particle);
    world.step(frame);
    world.remove(4);
    world.step(frame);
  });
}

// Queries of the first scene find them, by their numbers, and no more once they are gone.
TEST(AddingShapes, AreFoundByQueries) {
  World world(floor_alone(), {});
  Queries queries(floor_alone(), {.rod_radius = 0.5});
  const auto look = [&](double z) {
    queries.update(world);
    return queries.cast_ray({.origin = {0.15, 5, z}, .direction = {0, -1, 0}, .length = 10});
  };
  constexpr QueryTarget ground{QueryTarget::Kind::shape, ShapeKind::plane, 0};
  EXPECT_EQ(look(0).target, ground);
  const Added first = world.add(rope({0, 1, 0}, {1, 0, 0})), second = world.add(rope({0, 1, 3}, {1, 0, 0}));
  for (const Added& added : {first, second}) {
    const Hit hit = look(added == first ? 0 : 3);
    EXPECT_EQ(hit.target, (QueryTarget{QueryTarget::Kind::shape, ShapeKind::capsule, added.capsule + 1}));
    EXPECT_NEAR(hit.distance, 4 - radius, 1e-12);
  }
  world.remove(first.particle);
  EXPECT_EQ(look(0).target, ground);
  world.cut(second.rod + 1);
  world.step(1e-3);
  EXPECT_EQ(look(3).target, ground);
}

TEST(AddingShapes, AreRefusedWithAReason) {
  World world(floor_alone(), {});
  Scene fixed_ones = rope({0, 1, 0}, {1, 0, 0});
  for (Particle& each : fixed_ones.particles) each.fixed = true;
  fixed_ones.rods.clear();
  expect_refusal("capsule 0: nothing movable has it", [&] { world.add(fixed_ones); });
  World bare(rope({0, 1, 0}, {1, 0, 0}), {});
  bare.add(rope({0, 2, 0}, {1, 0, 0}));
  Scene no_shapes = rope({0, 1, 0}, {1, 0, 0});
  no_shapes.capsules.clear();
  World without(no_shapes, {});
  expect_refusal("began without them and without ground", [&] { without.add(rope({0, 2, 0}, {1, 0, 0})); });
}

}  // namespace
}  // namespace plumb::PLUMB_TEST_FILE
