// Islands that are added to a world while it runs, and removed.

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <string>
#include <vector>

#include "step/breaks/addition.hpp"
#include "step/breaks/ids.hpp"
#include "step/breaks/log.hpp"
#include "step/breaks/numbers.hpp"
#include "step/inputs/cords.hpp"
#include "step/rows.hpp"
#include "support/edited_worlds.hpp"
#include "support/snapshots.hpp"
#include "support/worlds.hpp"

namespace plumb::PLUMB_TEST_FILE {
namespace {

using test::expect_refusal;
using test::fixed;
using test::for_methods;
using test::movable;

constexpr double frame = 1.0 / 60;
constexpr Vec3 gravity{0, -9.81, 0};

/// Appends a chain of rods of 0.1 m that hangs aside from an anchor at x.
void append_chain(Scene& scene, double x, std::uint32_t rods) {
  const auto first = static_cast<std::uint32_t>(scene.particles.size());
  scene.particles.push_back(fixed({x, 0, 0}));
  for (std::uint32_t i = 1; i <= rods; ++i) {
    scene.particles.push_back(movable({x + 0.06 * i, -0.08 * i, 0}, 1, {0, 0, 0.1 * i}));
    scene.rods.push_back({.a = first + i - 1, .b = first + i});
  }
}

Scene chains(std::uint32_t count, std::uint32_t rods, double x = 0) {
  Scene scene;
  for (std::uint32_t i = 0; i < count; ++i) append_chain(scene, x + i, rods);
  return scene;
}

/// Returns one scene after the other, as one.
Scene joined(Scene scene, const Scene& with) {
  const auto first = static_cast<std::uint32_t>(scene.particles.size());
  scene.particles.insert(scene.particles.end(), with.particles.begin(), with.particles.end());
  for (Rod rod : with.rods) {
    rod.a += first;
    rod.b += first;
    scene.rods.push_back(rod);
  }
  for (Bend bend : with.bends) {
    for (std::uint32_t* const end : {&bend.a, &bend.b, &bend.c}) *end += first;
    scene.bends.push_back(bend);
  }
  for (Tackle tackle : with.tackles) {
    for (std::uint32_t& particle : tackle.particles) particle += first;
    scene.tackles.push_back(tackle);
  }
  return scene;
}

void expect_equal(const World& world, const World& other, std::uint32_t first, std::uint32_t end) {
  for (std::uint32_t i = first; i < end; ++i) {
    EXPECT_EQ(world.position(i), other.position(i)) << i;
    EXPECT_EQ(world.velocity(i), other.velocity(i)) << i;
  }
}

// --- What it is made of

TEST(Rows, KeepTheirItemsWhileOthersGrow) {
  using Entry = detail::Rows<int>::Entry;
  const std::vector<Entry> entries{{1, 5}, {0, 4}, {1, 6}};
  detail::Rows<int> rows(2, entries);
  rows.grow(3);
  for (int i = 0; i < 9; ++i) {
    const std::vector<int> more(static_cast<std::size_t>(i), i);
    rows.replace(2, more);
    EXPECT_TRUE(std::equal(more.begin(), more.end(), rows.of(2).begin(), rows.of(2).end()));
    EXPECT_EQ(rows.of(0)[0], 4);
    EXPECT_EQ(rows.of(1)[1], 6);
  }
  EXPECT_LT(rows.items().size(), 3 * 12u);
}

TEST(CordTable, HasRodsAndLinesApart) {
  detail::CordTable<int> table({1, 2}, {3});
  table.grow(3, 2);
  table[detail::first_line + 1] = 5;
  EXPECT_EQ(table[1], 2);
  EXPECT_EQ(table[2], 0);
  EXPECT_EQ(table[detail::first_line], 3);
  EXPECT_EQ(table[detail::first_line + 1], 5);
  EXPECT_EQ(table.rods(), 3u);
  EXPECT_EQ(table.lines(), 2u);
}

TEST(Ids, AscendEachOnce) {
  detail::Ids ids{4, 2, 4, 1};
  detail::sort_once(ids);
  EXPECT_EQ(ids, (detail::Ids{1, 2, 4}));
}

TEST(Addition, IsEqualInAllMembers) {
  Scene scene = chains(1, 3);
  scene.bends = {{.a = 0, .b = 1, .c = 2, .stiffness = 1}};
  scene.tackles = {{.particles = {1, 3}, .law = {.one_sided = true}}};
  scene.bodies.push_back({.mass = 1});
  scene.pins.emplace_back();
  scene.alignments.emplace_back();
  scene.angles.emplace_back();
  scene.springs.emplace_back();
  scene.torsions.emplace_back();
  scene.capsules.emplace_back();
  scene.hulls.push_back({.points = {{}}});
  const detail::Addition one(scene, {.rods = 3});
  EXPECT_TRUE(one == detail::Addition(one.scene, {.rods = 3}));
  const auto differs = [&](auto&& change) {
    detail::Addition other = one;
    change(other);
    return !(one == other);
  };
  EXPECT_TRUE(differs([](detail::Addition& of) { of.scene.particles[1].velocity.z = 9; }));
  EXPECT_TRUE(differs([](detail::Addition& of) { of.scene.rods[2].law.strength = 9; }));
  EXPECT_TRUE(differs([](detail::Addition& of) { of.scene.bends[0].damping = 9; }));
  EXPECT_TRUE(differs([](detail::Addition& of) { of.scene.tackles[0].particles[0] = 2; }));
  EXPECT_TRUE(differs([](detail::Addition& of) { of.scene.bodies[0].inertia.yz = 9; }));
  EXPECT_TRUE(differs([](detail::Addition& of) { of.scene.pins[0].b.weights[3] = 9; }));
  EXPECT_TRUE(differs([](detail::Addition& of) { of.scene.alignments[0].v.to.particles[0] = 9; }));
  EXPECT_TRUE(differs([](detail::Addition& of) { of.scene.angles[0].damping = 9; }));
  EXPECT_TRUE(differs([](detail::Addition& of) { of.scene.springs[0].one_sided = true; }));
  EXPECT_TRUE(differs([](detail::Addition& of) { of.scene.torsions[0].torque = 9; }));
  EXPECT_TRUE(differs([](detail::Addition& of) { of.scene.capsules[0].surface.spinning = 9; }));
  EXPECT_TRUE(differs([](detail::Addition& of) { of.scene.hulls[0].points[0].y = 9; }));
  EXPECT_TRUE(differs([](detail::Addition& of) { of.scene.hulls[0].filter.own_island = true; }));
  EXPECT_TRUE(differs([](detail::Addition& of) { of.first.bends = 9; }));
}

TEST(Numbers, AreTheLowestInARow) {
  detail::Numbers numbers(10);
  EXPECT_EQ(numbers.find(4), 10u);
  numbers.give_back(std::vector<std::uint32_t>{2, 3, 7});
  EXPECT_FALSE(numbers.has(3));
  EXPECT_EQ(numbers.generation(3), 2u);
  EXPECT_EQ(numbers.generation(4), 1u);
  EXPECT_EQ(numbers.find(2), 2u);
  EXPECT_EQ(numbers.find(3), 10u);
  numbers.give_back(std::vector<std::uint32_t>{8, 9});
  EXPECT_EQ(numbers.find(5), 7u);
  numbers.take(7, 5);
  EXPECT_EQ(numbers.count(), 12u);
  EXPECT_EQ(numbers.generation(7), 3u);
  EXPECT_EQ(numbers.generation(11), 1u);
  numbers.take(2, 1);
  EXPECT_EQ(numbers.find(1), 3u);
  numbers.give_back(std::vector<std::uint32_t>{2, 4});
  EXPECT_EQ(numbers.find(3), 2u);
}

TEST(Log, ForgetsWhatWasAddedAndRemoved) {
  const auto added = [](std::uint32_t first, std::size_t particles) {
    detail::Split out;
    out.added.emplace_back().first.particles = first;
    out.added.back().scene.particles.resize(particles);
    return out;
  };
  using Ids = std::vector<std::uint32_t>;
  detail::Log log;
  for (const auto& [first, count] : {std::pair{3u, 2u}, {5u, 3u}, {8u, 1u}})
    log.push_addition(added(first, count));
  EXPECT_EQ(log.splits().size(), 3u);
  log.push_removal({.removed = {5}}, Ids{5, 7});
  EXPECT_EQ(log.splits().size(), 4u);
  log.push_removal({.removed = {6}}, Ids{6});
  EXPECT_TRUE(log.is_of(std::vector{added(3, 2), added(8, 1)}));
  log.push({.rods = {1}}, log.join(Ids{4}));  // a rod of it breaks
  log.push_removal({.removed = {3}}, Ids{3, 4});
  EXPECT_TRUE(log.is_of(std::vector{added(8, 1)}));
  log.push_addition(added(3, 2));
  log.push({.rods = {2}}, log.join(Ids{4, 8}));  // what comes together ends together
  log.push_removal({.removed = {3}}, Ids{3, 4});
  EXPECT_EQ(log.splits().size(), 4u);
  log.push_removal({.removed = {8}}, Ids{8});
  EXPECT_EQ(log.splits().size(), 0u);
  log.push_addition(added(3, 2));
  log.push({.rods = {2}}, log.join(Ids{0, 4}));  // and what comes together with the scene stays with it
  log.push_removal({.removed = {3}}, Ids{3, 4});
  EXPECT_EQ(log.splits().size(), 3u);
  log.push_removal({.removed = {0}}, Ids{0});
  EXPECT_EQ(log.splits().size(), 4u);
}

// --- Adding

// A world to which ropes are added at its start is the world that had them in its scene.
TEST(Adding, EqualsAWorldThatHadItFromTheStart) {
  const Scene scene = chains(3, 8), more = chains(2, 5, 10);
  for_methods([&](const Settings& settings) {
    World world(scene, settings), fresh(joined(scene, more), settings);
    EXPECT_EQ(world.add(more), (Added{.particle = 27, .rod = 24}));
    EXPECT_EQ(world.particle_count(), 39u);
    EXPECT_EQ(world.rod_count(), 34u);
    EXPECT_EQ(world.info().islands, 5u);
    EXPECT_EQ(world.info().rods, 34u);
    const double rounding = settings.precision == Precision::single ? 1e-5 : 1e-12;
    EXPECT_LE(norm(world.position(38) - more.particles[11].position), rounding);
    for (int i = 0; i < 3; ++i) {
      EXPECT_EQ(world.step(frame).awake_islands, 5u);
      fresh.step(frame);
      EXPECT_LE(rms_distance(test::positions_of(world), test::positions_of(fresh)), rounding);
      EXPECT_LE(rms_distance(test::velocities_of(world), test::velocities_of(fresh)), 100 * rounding);
    }
  });
}

// A world in which things come, fall apart and go takes no more memory for it in the end.
TEST(Adding, ForgetsWhatFellApartAndWent) {
  const Scene scene = chains(2, 4), more = chains(1, 6, 20);
  for_methods([&](const Settings& settings) {
    World world(scene, settings), other(scene, settings);
    std::vector<std::size_t> sizes;
    for (int i = 0; i < 4; ++i) {
      const Added one = world.add(more), two = world.add(more);
      world.step(frame);
      world.cut(one.rod + 2);
      world.join({.a = one.particle + 6, .b = two.particle + 5});
      world.step(frame);
      world.set_mass(one.particle + 1, 2);
      world.fix(two.particle + 3);
      world.step(frame);
      world.cut(two.rod + 4);
      world.step(frame);
      for (std::uint32_t k = one.particle; k < one.particle + 14; ++k)
        if (world.handle<Particle>(k) && !(world.velocity(k) == Vec3{})) world.remove(k);
      for (std::uint32_t k = one.particle; k < one.particle + 14; ++k)
        if (world.handle<Particle>(k)) world.remove(k);
      world.step(frame);
      sizes.push_back(world.snapshot_size());
    }
    EXPECT_EQ(sizes.back(), sizes[0]);
    std::vector<std::byte> bytes(world.snapshot_size());
    world.save(bytes);
    other.restore(bytes);
    EXPECT_EQ(other.state_hash(), world.state_hash());
    EXPECT_EQ(other.add(more), world.add(more));
    for (World* const each : {&world, &other}) test::run(*each, frame, 3);
    EXPECT_EQ(other.state_hash(), world.state_hash());
  });
}

// What is added while others move starts as a world of its own, and others do not feel it.
TEST(Adding, LeavesOthersTheirBits) {
  const Scene scene = chains(9, 8), more = chains(2, 8, 20);
  for_methods([&](const Settings& settings) {
    World world(scene, settings), other(scene, settings), alone(more, settings);
    test::run(world, frame, 20);
    test::run(other, frame, 20);
    const Added first = world.add(more);
    test::run(world, frame, 30);
    test::run(other, frame, 30);
    test::run(alone, frame, 30);
    expect_equal(world, other, 0, 81);
    for (std::uint32_t i = 0; i < 18; ++i) {
      EXPECT_EQ(world.position(first.particle + i), alone.position(i)) << i;
      EXPECT_EQ(world.velocity(first.particle + i), alone.velocity(i)) << i;
    }
  });
}

// What flies has the momentum that it was given, and takes none from others.
TEST(Adding, KeepsMomentum) {
  Scene flying = chains(1, 8);
  flying.particles[0] = movable({}, 2, {1, 0, 0});
  const auto momentum = [&](const World& world, std::uint32_t first) {
    Vec3 sum;
    for (std::uint32_t i = 0; i < 9; ++i) sum += flying.particles[i].mass * world.velocity(first + i);
    return sum;
  };
  Vec3 given;
  for (const Particle& particle : flying.particles) given += particle.mass * particle.velocity;
  for_methods([&](const Settings& settings) {
    World world(flying, settings);
    test::run(world, frame, 5);
    const Vec3 before = momentum(world, 0);
    const std::uint32_t first = world.add(flying).particle;
    const double rounding = settings.precision == Precision::single ? 1e-4 : 1e-11;
    EXPECT_EQ(momentum(world, 0), before);
    EXPECT_LE(norm(momentum(world, first) - given), rounding);
    test::run(world, frame, 5);
    const double late = settings.gradient == Gradient::new_ ? 0.5 * frame / settings.substeps : 0;
    const Vec3 gained = (10 * 5 * frame) * gravity;
    EXPECT_LE(norm(momentum(world, first) - given - gained), 2 * rounding + 10 * late * norm(gravity));
    world.remove(first);
    EXPECT_LE(norm(momentum(world, 0) - before - gained), rounding);
  });
}

TEST(Adding, TakesForcesAnchorsAndReadingAtOnce) {
  World world(chains(2, 4), {.tensions = true, .threads = 1});
  test::run(world, frame, 5);
  Scene rope;
  rope.particles = {fixed({5, 0, 0}), movable({5, -1, 0}), movable({5, -2, 0})};
  rope.rods = {{.a = 0, .b = 1}, {.a = 1, .b = 2}};
  const Added first = world.add(rope);
  EXPECT_EQ(test::positions_of(world)[first.particle + 2], (Vec3{5, -2, 0}));
  EXPECT_EQ(test::velocities_of(world)[first.particle + 2], Vec3{});
  world.set_force(first.particle + 2, {0, -10, 0});
  world.step(frame);
  EXPECT_NEAR(world.tension(first.rod), 2 * 9.81 + 10, 1e-9);
  EXPECT_NEAR(world.tension(first.rod + 1), 9.81 + 10, 1e-9);
  EXPECT_NEAR(world.reaction(first.particle).y, 2 * 9.81 + 10, 1e-9);
  EXPECT_NEAR(world.reaction(0).y, 4 * 9.81, 4 * 9.81);
  EXPECT_TRUE(world.problems().empty());
  world.move_anchor(first.particle, {5, 0, 0.01});
  world.step(frame);
  EXPECT_EQ(world.position(first.particle), (Vec3{5, 0, 0.01}));
  EXPECT_NE(world.position(first.particle + 1).z, 0);
}

// A scene that says another gravity than the world's means something else. The default says nothing.
TEST(Adding, RefusesAnotherGravity) {
  World world(chains(1, 4), {.threads = 1});
  world.set_gravity({0, 0, 5});
  Scene ball;
  ball.particles = {movable({3, 0, 0}, 2)};
  ball.gravity = {0, -1.6, 0};
  expect_refusal("gravity: what is added has", [&] { world.add(ball); });
  EXPECT_EQ(world.particle_count(), 5u);
  ball.gravity = {0, 0, 5};
  EXPECT_EQ(world.add(ball).particle, 5u);
  ball.gravity = gravity;
  EXPECT_EQ(world.add(ball).particle, 6u);
}

TEST(Adding, SeesGravityAndLoadsOfTheWorld) {
  World world(chains(1, 4), {.threads = 1});
  world.set_gravity({0, 0, 5});
  world.set_load([](const LoadState& view, std::span<Vec3> forces) {
    ASSERT_EQ(view.positions.size(), forces.size());
    if (forces.size() > 5) forces[5] = {6, 0, 0};
  });
  test::run(world, frame, 3);
  Scene ball;
  ball.particles = {movable({3, 0, 0}, 2)};
  EXPECT_EQ(world.add(ball).particle, 5u);
  test::run(world, frame, 6);
  EXPECT_LE(norm(world.velocity(5) - 0.1 * Vec3{3, 0, 5}), 1e-12);
  world.remove(5);
  test::run(world, frame, 2);
  EXPECT_EQ(world.add(ball).particle, 5u);
  test::run(world, frame, 6);
  EXPECT_LE(norm(world.velocity(5) - 0.1 * Vec3{3, 0, 5}), 1e-12);
}

// A load that was set while there was nothing acts on what is added.
TEST(Adding, IsLoadedInAWorldThatWasEmpty) {
  World world(Scene{}, {.threads = 1});
  world.set_load([](const LoadState& view, std::span<Vec3> forces) {
    ASSERT_EQ(view.positions.size(), forces.size());
    for (Vec3& force : forces) force = {2, 0, 0};
  });
  world.step(frame);
  Scene ball;
  ball.particles = {movable({3, 0, 0})};
  world.add(ball);
  test::run(world, 0.1, 5);
  EXPECT_NEAR(world.velocity(0).x, 1, 1e-12);
}

// A world may begin with nothing.
TEST(Adding, FillsAnEmptyWorld) {
  World world(Scene{}, {.threads = 1}), other(chains(2, 3), {.threads = 1});
  world.step(frame);
  EXPECT_EQ(world.add(chains(2, 3)), Added{});
  for (World* const each : {&world, &other}) EXPECT_EQ(each->step(frame).awake_islands, 2u);
  expect_equal(world, other, 0, 8);
}

// An accuracy is relative to what a world begins with, or else to the first addition that has a size.
TEST(Adding, GivesAnAccuracyItsSize) {
  const Settings settings{.accuracy = 1e-3, .threads = 1};
  Scene point;
  point.particles = {movable({0, 3, 0})};
  World world(point, settings), other(chains(1, 8), settings);
  EXPECT_EQ(world.step(frame).substeps, 1u);
  world.add(point);
  world.add(chains(1, 8));
  World restored(point, settings);
  const test::Snapshot before = test::snapshot_of(world);
  for (int i = 0; i < 8; ++i) EXPECT_EQ(world.step(frame).substeps, other.step(frame).substeps);
  for (std::uint32_t i = 0; i < 9; ++i) EXPECT_EQ(world.position(2 + i), other.position(i)) << i;
  restored.restore(before);
  test::run(restored, frame, 8);
  for (std::uint32_t i = 0; i < 9; ++i) EXPECT_EQ(restored.position(2 + i), other.position(i)) << i;
  world.add(chains(2, 8, 100));  // which lie in a box ten times as large
  for (World* const each : {&world, &other}) test::run(*each, frame, 8);
  for (std::uint32_t i = 0; i < 9; ++i) EXPECT_EQ(world.position(2 + i), other.position(i)) << i;
}

// What is added may be edited as what was there, at once or later.
TEST(Adding, MayBeEdited) {
  const Scene scene = chains(2, 6), more = chains(1, 6, 5);
  for_methods([&](const Settings& settings) {
    World world(scene, settings), other(joined(scene, more), settings);
    world.add(more);
    for (World* const each : {&world, &other}) {
      each->cut(14);
      test::run(*each, frame, 2);
      each->fix(16);
      each->set_mass(20, 3);
      test::run(*each, frame, 2);
      each->free(16);
      EXPECT_EQ(each->step(frame).awake_islands, 4u);
    }
    const double rounding = settings.precision == Precision::single ? 1e-4 : 1e-11;
    EXPECT_LE(rms_distance(test::positions_of(world), test::positions_of(other)), rounding);
    std::vector<std::uint32_t> particles;
    std::vector<Vec3> positions, velocities;
    for (const std::uint32_t i : {17u, 18u, 19u, 20u}) {
      particles.push_back(i);
      positions.push_back(world.position(i) + Vec3{0, 0, 1});
      velocities.push_back(world.velocity(i));
    }
    world.teleport(particles, positions, velocities);
    particles.front() = 16;
    expect_refusal("rod 13: is 0.1", [&] { world.teleport(particles, positions, velocities); });
    EXPECT_LE(norm(world.position(20) - positions[3]), rounding);
    EXPECT_EQ(world.step(frame).unsolved, 0u);
  });
}

// Bends and tackles come with their rods. Tackles of the scene stay what they are.
TEST(Adding, TakesBendsAndTackles) {
  Scene lift;
  lift.particles = {fixed({0, 0, 0}), movable({-0.5, -1, 0}, 1), movable({0.5, -1, 0}, 1.5)};
  lift.tackles = {{.particles = {1, 0, 2}}};
  Scene wire = chains(1, 6, 5);
  for (std::uint32_t i = 1; i < 6; ++i)
    wire.bends.push_back({.a = i - 1, .b = i, .c = i + 1, .stiffness = 0.3});
  Scene other = lift;
  for (Particle& particle : other.particles) particle.position.x += 3;
  other.particles[2].mass = 4;
  const Settings settings{.tensions = true, .threads = 1};
  World world(lift, settings), fresh(joined(joined(lift, wire), other), settings);
  EXPECT_EQ(world.add(wire).bend, 0u);
  const Added first = world.add(other);
  EXPECT_EQ(first, (Added{.particle = 10, .rod = 6, .bend = 5, .tackle = 1}));
  EXPECT_TRUE(std::isnan(world.tackle_tension(1)));
  for (int i = 0; i < 4; ++i) {
    for (World* const each : {&world, &fresh}) {
      each->set_tackle_length(1, tackle_length(other, 0) - 0.01 * i);
      each->step(frame);
    }
    EXPECT_LE(rms_distance(test::positions_of(world), test::positions_of(fresh)), 1e-12);
    EXPECT_NEAR(world.tackle_tension(0), fresh.tackle_tension(0), 1e-9);
    EXPECT_NEAR(world.tackle_tension(1), fresh.tackle_tension(1), 1e-9);
    EXPECT_NEAR(world.tackle_power(1), fresh.tackle_power(1), 1e-8);
  }
  expect_refusal("particle 11: is of tackle 1", [&] { world.fix(11); });
  world.remove(11);
  expect_refusal("tackle 1: was removed", [&] { (void)world.tackle_tension(1); });
  expect_refusal("tackle 1: was removed", [&] { world.set_tackle_length(1, 2); });
  world.step(frame);
  EXPECT_EQ(world.add(other), first);
  world.step(frame);
  EXPECT_GT(world.tackle_tension(1), 9.81);
}

TEST(Adding, LetsRodsBreak) {
  Scene weak = chains(1, 6, 5);
  weak.rods[2].law.strength = 20;
  World world(chains(2, 6), {.threads = 1});
  test::run(world, frame, 3);
  const Added first = world.add(weak);
  StepReport all = test::run(world, frame, 60);
  EXPECT_EQ(all.broken_rods, 1u);
  EXPECT_TRUE(world.is_broken(first.rod + 2));
  EXPECT_EQ(all.awake_islands, 4u);
  world.remove(first.particle + 1);
  EXPECT_EQ(world.step(frame).awake_islands, 3u);
  world.remove(first.particle + 6);
  EXPECT_EQ(world.add(weak), first);
  EXPECT_FALSE(world.is_broken(first.rod + 2));
  all = test::run(world, frame, 60);
  EXPECT_EQ(all.broken_rods, 1u);
  EXPECT_EQ(all.awake_islands, 4u);
}

TEST(Adding, RefusesWithAReason) {
  World world(chains(2, 4), {.threads = 1});
  const std::uint64_t before = world.state_hash();
  const auto refuses = [&](const std::string& reason, auto&& change) {
    Scene scene = chains(1, 4, 5);
    change(scene);
    expect_refusal(reason, [&] { world.add(scene); });
  };
  refuses("rod 4: ", [](Scene& s) { s.rods.push_back({.a = 0, .b = 9}); });
  refuses("particle 2: ", [](Scene& s) { s.particles[2].position.x = std::nan(""); });
  refuses("drag: what is added has 0.5 1/s", [](Scene& s) { s.drag = 0.5; });
  refuses("twist 0: cannot be added", [](Scene& s) {
    s.twists = {{.particles = {1, 2, 3}, .stiffness = 1}};
  });
  refuses("reel 0: cannot be added", [](Scene& s) { s.reels = {{.particles = {0, 1, 2}}}; });
  refuses("plane 0: cannot be added", [](Scene& s) { s.planes.push_back({}); });
  refuses("particle 1: its island has shapes, bodies, joints, air or sleepers, which cannot be added",
          [](Scene& s) { s.capsules = {{.a = point_at(1), .b = point_at(2), .radius = 0.1}}; });
  refuses("particle 1: its island has shapes, bodies, joints, air or sleepers", [](Scene& s) {
    for (Particle& each : s.particles) each.asleep = true;
  });
  refuses("particle 1: its island has shapes, bodies, joints, air or sleepers, which cannot be added",
          [](Scene& s) { s.rods[1].mass = s.rods[1].linear_drag = 1; });
  refuses("no particles", [](Scene& s) { s = {}; });
  EXPECT_EQ(world.state_hash(), before);
  EXPECT_EQ(world.particle_count(), 10u);
  World old(chains(1, 4), {.method = Method::springs});
  expect_refusal("springs, multipliers and featherstone add nothing", [&] { old.add(chains(1, 2)); });
  World shake(chains(1, 4), {.gradient = Gradient::old});
  Scene wire = chains(1, 3);
  wire.bends = {{.a = 0, .b = 1, .c = 2, .stiffness = 1}};
  expect_refusal("bend 0: gradient old", [&] { shake.add(wire); });
  EXPECT_EQ(shake.particle_count(), 5u);
}

// --- Removing

TEST(Removing, LeavesOthersTheirBits) {
  const Scene scene = chains(9, 8);
  for_methods([&](Settings settings) {
    settings.tensions = true;
    World world(scene, settings), other(scene, settings);
    test::run(world, frame, 20);
    test::run(other, frame, 20);
    world.set_force(9 * 4 + 3, {1, 2, 3});
    world.remove(9 * 4 + 2);
    EXPECT_EQ(world.info().islands, 8u);
    const StepReport report = world.step(frame);
    EXPECT_EQ(report.awake_islands, 8u);
    test::run(world, frame, 29);
    test::run(other, frame, 30);
    expect_equal(world, other, 0, 36);
    expect_equal(world, other, 45, 81);
    EXPECT_EQ(world.tension(40), other.tension(40));
    EXPECT_EQ(world.reaction(45), other.reaction(45));
    EXPECT_TRUE(world.problems().empty());
    expect_refusal("particle 38: was removed", [&] { (void)world.position(38); });
    expect_refusal("particle 36: was removed", [&] { world.move_anchor(36, {}); });
    expect_refusal("rod 33: was removed", [&] { world.cut(33); });
    std::vector<double> tensions(72);
    world.copy_tensions(tensions);
    std::vector<Vec3> reactions(81);
    world.copy_reactions(reactions);
    EXPECT_EQ(tensions[33], 0);
    EXPECT_EQ(reactions[36], Vec3{});
    EXPECT_EQ(test::positions_of(world)[38], Vec3{});
    EXPECT_EQ(test::velocities_of(world)[38], Vec3{});
  });
}

// An anchor goes with the last island that hangs from it.
TEST(Removing, TakesAnchorsFromWhichNothingHangs) {
  Scene scene = chains(1, 3);
  scene.particles.push_back(movable({0, -0.1, 0}));
  scene.rods.push_back({.a = 0, .b = 4});
  scene.particles.push_back(fixed({9, 9, 9}));
  World world(scene, {.tensions = true, .threads = 1});
  world.step(frame);
  expect_refusal("particle 0: is fixed, and something hangs from it", [&] { world.remove(0); });
  world.remove(2);
  EXPECT_EQ(world.position(0), Vec3{});
  world.step(frame);
  EXPECT_NEAR(world.reaction(0).y, 9.81, 1e-9);
  world.remove(4);
  expect_refusal("particle 0: was removed", [&] { (void)world.position(0); });
  EXPECT_EQ(world.position(5), (Vec3{9, 9, 9}));
  world.remove(5);
  EXPECT_EQ(world.step(frame).awake_islands, 0u);
  EXPECT_EQ(world.add(chains(1, 5)), Added{});
  EXPECT_EQ(world.particle_count(), 6u);
  EXPECT_EQ(world.step(frame).awake_islands, 1u);
}

// What was ordered of an island ends with it, and what takes its numbers is new.
TEST(Removing, EndsWhatWasOrdered) {
  const Scene scene = chains(2, 4), more = chains(1, 4, 7);
  World world(scene, {.tensions = true, .threads = 1}), other(more, {.tensions = true, .threads = 1});
  test::run(world, frame, 3);
  world.set_force(3, {0, 0, 50});
  world.set_mass(3, 5);
  world.cut(2);
  world.fix(2);
  world.move_anchor(0, {0, 3, 0});
  world.set_length(0, 0.2);
  world.remove(1);
  EXPECT_EQ(world.add(more), Added{});
  for (int i = 0; i < 5; ++i) {
    EXPECT_EQ(world.step(frame).awake_islands, 2u);
    other.step(frame);
    expect_equal(world, other, 0, 5);
    EXPECT_EQ(world.tension(2), other.tension(2));
    EXPECT_EQ(world.reaction(0), other.reaction(0));
  }
}

TEST(Removing, IsRefusedWithAReason) {
  Scene scene = chains(3, 4);
  scene.capsules.push_back({.a = point_at(1), .b = point_at(2), .radius = 0.01});
  scene.particles.push_back(fixed({0, -5, 0}));
  scene.particles.push_back(fixed({1, -5, 0}));
  scene.capsules.push_back({.a = point_at(15), .b = point_at(16), .radius = 0.1});
  World world(scene, {.threads = 1});
  expect_refusal("particle 17: unknown", [&] { world.remove(17); });
  expect_refusal("particle 15: a shape is at it", [&] { world.remove(15); });
  expect_refusal("particle 0: is fixed, and something hangs from it", [&] { world.remove(0); });
  world.remove(8);
  expect_refusal("particle 8: was removed", [&] { world.remove(8); });
  world.add(chains(2, 4, 9));
  EXPECT_EQ(world.step(frame).awake_islands, 4u);
  Scene sprung = chains(2, 4);
  sprung.particles.push_back(fixed({0, -1, 0}));
  sprung.springs = {{.a = point_at(10), .b = point_at(4), .stiffness = 100},
                    {.a = point_at(5), .b = point_at(4), .stiffness = 100}};
  World held(sprung, {.threads = 1});
  expect_refusal("particle 10: is fixed, and something hangs from it", [&] { held.remove(10); });
  held.remove(9);  // and particle 5 stays, since a spring is at it
  expect_refusal("particle 5: is fixed, and something hangs from it", [&] { held.remove(5); });
  EXPECT_EQ(held.step(frame).unsolved, 0u);
  Scene reel = chains(1, 4);
  for (std::uint32_t i = 0; i < 5; ++i) reel.particles[i].position = {0, -0.1 * i, 0};
  reel.reels = {{.particles = {0, 1, 2, 3}}};
  World reeled(reel, {.threads = 1});
  expect_refusal("particle 3: reel 0 is of its island", [&] { reeled.remove(3); });
  const double out = reeled.reel_out(0);
  reeled.add(chains(1, 4, 3));
  reeled.set_reel(0, 0.9 * out);
  reeled.step(frame);
  EXPECT_NEAR(reeled.reel_out(0), 0.9 * out, 1e-12);
}

// --- Handles

TEST(Handles, AreRefusedOnceWhatTheyNameIsGone) {
  World world(chains(2, 4), {.threads = 1});
  const Handle<Particle> particle = world.handle<Particle>(7);
  const Handle<Rod> rod = world.handle<Rod>(5);
  EXPECT_TRUE(particle);
  EXPECT_FALSE(Handle<Particle>{});
  EXPECT_EQ(world.number(particle), 7u);
  EXPECT_EQ(world.number(rod), 5u);
  world.remove(6);
  EXPECT_FALSE(world.has(particle));
  EXPECT_FALSE(world.has(rod));
  expect_refusal("particle 7: was removed; its handle is of generation 1, now 2",
                 [&] { (void)world.number(particle); });
  EXPECT_EQ(world.handle<Particle>(7), Handle<Particle>{});
  EXPECT_EQ(world.handle<Rod>(5), Handle<Rod>{});
  expect_refusal("particle 10: unknown", [&] { (void)world.handle<Particle>(10); });
  EXPECT_EQ(world.add(chains(1, 4)), (Added{.particle = 5, .rod = 4}));
  expect_refusal("rod 5: was removed; its handle is of generation 1, now 3",
                 [&] { (void)world.number(rod); });
  const Handle<Particle> later = world.handle<Particle>(7);
  EXPECT_FALSE(later == particle);
  EXPECT_TRUE(world.has(later));
  EXPECT_FALSE(world.has(Handle<Particle>{}));
  expect_refusal("particle: the handle names none", [&] { (void)world.number(Handle<Particle>{}); });
  const Handle<Rod> strange{3, 7};
  EXPECT_FALSE(world.has(strange));
  expect_refusal("is not of this world", [&] { (void)world.number(strange); });
}

// --- Snapshots

// An older snapshot brings back what was there then, handles too. What came and went leaves no trace.
TEST(Adding, IsKnownToSnapshots) {
  const Scene scene = chains(3, 6), more = chains(2, 6, 10);
  for_methods([&](Settings settings) {
    settings.tensions = true;
    World world(scene, settings);
    test::run(world, frame, 3);
    const test::Snapshot before = test::snapshot_of(world);
    world.set_gravity({1, -9, 0});
    world.step(frame);
    const Added first = world.add(more);
    test::run(world, frame, 2);
    world.remove(8);
    const Handle<Particle> added = world.handle<Particle>(first.particle + 3);
    test::run(world, frame, 2);
    const test::Snapshot then = test::snapshot_of(world);
    test::run(world, frame, 5);
    const std::uint64_t end = world.state_hash();
    world.restore(before);
    EXPECT_EQ(world.particle_count(), 21u);
    EXPECT_LE(norm(world.position(8) - scene.particles[8].position), 0.2);
    EXPECT_FALSE(world.has(added));
    World fresh(scene, settings);
    for (World* const each : {&world, &fresh}) {
      each->restore(then);
      EXPECT_TRUE(each->has(added));
      EXPECT_EQ(each->number(added), first.particle + 3);
      expect_refusal("particle 8: was removed", [&] { (void)each->position(8); });
      EXPECT_TRUE(test::snapshot_of(*each) == then);
      test::run(*each, frame, 5);
      EXPECT_EQ(each->state_hash(), end);
    }
    std::size_t size = 0;
    for (int i = 0; i < 20; ++i) {
      const Added again = world.add(more);
      world.step(frame);
      world.remove(again.particle + 1);
      world.remove(again.particle + 8);
      if (i == 1) size = world.snapshot_size();
    }
    EXPECT_EQ(world.snapshot_size(), size);
    fresh.restore(test::snapshot_of(world));
    test::run(world, frame, 3);
    test::run(fresh, frame, 3);
    EXPECT_EQ(fresh.state_hash(), world.state_hash());
  });
}

// The mass of an anchor moves nothing, and yet what was added was edited.
TEST(Adding, IsKeptForTheMassOfAnAnchor) {
  Scene more = chains(1, 3, 10);
  more.particles[0].mass = 1;
  World world(chains(1, 3), {.threads = 1}), fresh(chains(1, 3), {.threads = 1});
  const Added first = world.add(more);
  world.set_mass(first.particle, 50);
  world.step(frame);
  world.remove(first.particle + 1);
  fresh.restore(test::snapshot_of(world));
  for (World* const each : {&world, &fresh}) {
    EXPECT_EQ(each->add(more).particle, first.particle);
    each->free(first.particle);
    test::run(*each, frame, 5);
  }
  EXPECT_EQ(fresh.state_hash(), world.state_hash());
}

// The same edits give the same bits on any number of threads.
TEST(Adding, GivesTheSameBitsOnTwoThreads) {
  for (const Method method : {Method::direct, Method::relax}) {
    std::vector<std::uint64_t> hashes;
    for (const unsigned threads : {1u, 2u}) {
      World world(chains(40, 12), {.method = method, .threads = threads});
      for (std::uint32_t i = 0; i < 10; ++i) {
        world.remove(13 * (3 * i + 1) + 4);
        world.step(frame);
        world.add(chains(1, 12, 100 + i));
        world.add(chains(2, 5, 100 + i));
        world.step(frame);
      }
      hashes.push_back(world.state_hash());
    }
    EXPECT_EQ(hashes[0], hashes[1]);
  }
}

}  // namespace
}  // namespace plumb::PLUMB_TEST_FILE
