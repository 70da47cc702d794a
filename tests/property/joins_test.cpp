// Rods that join particles of a world while it runs.

#include <gtest/gtest.h>

#include <cmath>
#include <cstdint>
#include <string>

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
constexpr std::uint32_t size = 7;  // particles of a chain

/// Returns chains of six rods of 0.1 m, each from an anchor, the first at x (m).
Scene chains(std::uint32_t count, double x = 0) {
  Scene scene;
  for (std::uint32_t c = 0; c < count; ++c) {
    for (std::uint32_t i = 0; i < size; ++i) {
      const Vec3 at{x + 0.3 * c + 0.06 * i, -0.08 * i, 0.02 * c};
      scene.particles.push_back(movable(at, 1 + 0.1 * i, {0, 0, 0.1 * i}));
      if (i > 0) scene.rods.push_back({.a = size * c + i - 1, .b = size * c + i});
    }
    scene.particles[std::size_t{size} * c].fixed = true;
  }
  return scene;
}

Momentum momentum_of(const Scene& scene, const World& world) {
  return measure_momentum(scene, test::positions_of(world), test::velocities_of(world));
}
double energy_of(const Scene& scene, const World& world) {
  return measure_energy(scene, test::positions_of(world), test::velocities_of(world)).kinetic;
}

/// Returns the scene that a world is in, with its rods.
Scene now(Scene scene, const World& world) {
  for (std::uint32_t i = 0; i < scene.particles.size(); ++i) {
    scene.particles[i].position = world.position(i);
    if (!scene.particles[i].fixed) scene.particles[i].velocity = world.velocity(i);
  }
  return scene;
}

// A joined world goes on as one that is compiled of where it is, to rounding. Velocities of gradient new are
// means of a substep, and those of relaxation end where sweeps do: neither has all of a state.
TEST(Joins, GoOnAsAWorldOfThatScene) {
  const Scene scene = chains(3);
  for_methods([&](const Settings& settings) {
    for (const bool is_elastic : {false, true}) {
      World world(scene, settings);
      test::run(world, frame, 10);
      Rod rod{.a = 6, .b = 13};
      if (is_elastic) rod.law = {.stiffness = 1000, .damping = 1};
      Scene then = now(scene, world);
      const Handle<Rod> joined = world.join(rod);
      EXPECT_EQ(joined, (Handle<Rod>{18, 1}));
      EXPECT_EQ(world.number(joined), 18u);
      EXPECT_EQ(world.rod_count(), 19u);
      then.rods.push_back(rod);
      World fresh(then, settings);
      EXPECT_EQ(world.step(frame).awake_islands, 2u);
      EXPECT_EQ(fresh.step(frame).awake_islands, 2u);
      const double rounding = settings.method == Method::relax          ? 1e-6
                              : settings.gradient == Gradient::new_     ? 3e-4
                              : settings.precision == Precision::single ? 1e-7
                                                                        : 1e-14;
      for (std::uint32_t i = 0; i < 14; ++i) {
        EXPECT_LE(norm(world.position(i) - fresh.position(i)), rounding) << i;
        EXPECT_LE(norm(world.velocity(i) - fresh.velocity(i)), 100 * rounding) << i;
      }
      test::run(world, frame, 30);
      EXPECT_TRUE(world.problems(0.02).empty());
      EXPECT_FALSE(world.is_broken(18));
    }
  });
}

// Momentum and angular momentum stay, energy does not grow, and no particle jumps.
TEST(Joins, KeepMomentum) {
  for (const Gradient gradient : {Gradient::mid, Gradient::old}) {
    Scene scene = chains(2);
    scene.gravity = {};
    for (Particle& particle : scene.particles) particle.fixed = false;
    scene.particles[0].velocity = {3, 1, 2};
    World world(scene, {.method = Method::direct, .gradient = gradient, .threads = 1});
    test::run(world, frame, 5);
    const Momentum before = momentum_of(scene, world);
    const double energy = energy_of(scene, world);
    const Vec3 at = world.position(13);
    world.join({.a = 0, .b = 13});
    EXPECT_EQ(world.position(13), at);
    world.step(1e-9);
    EXPECT_LE(norm(world.position(13) - at), 1e-7);
    test::run(world, frame, 5);
    const Momentum after = momentum_of(scene, world);
    EXPECT_LE(norm(after.linear - before.linear), 1e-12 * norm(before.linear));
    EXPECT_LE(norm(after.angular - before.angular), 1e-12 * norm(before.angular)) << to_string(gradient);
    EXPECT_LE(energy_of(scene, world), energy * (1 + 1e-3));
  }
}

TEST(Joins, LeaveOthersTheirBits) {
  const Scene scene = chains(9);
  for_methods([&](const Settings& settings) {
    World world(scene, settings), other(scene, settings);
    for (World* const each : {&world, &other}) test::run(*each, frame, 10);
    world.join({.a = 3 * size + 2, .b = 4 * size + 5});
    for (World* const each : {&world, &other}) test::run(*each, frame, 20);
    for (std::uint32_t i = 0; i < 9 * size; ++i) {
      const std::uint32_t chain = i / size;
      if (chain == 3 || chain == 4) continue;
      EXPECT_EQ(world.position(i), other.position(i)) << i;
      EXPECT_EQ(world.velocity(i), other.velocity(i)) << i;
    }
  });
}

// Rods that are joined and cut in turns have the same bits on all instruction sets and threads, and so has a
// world that goes back across it.
TEST(Joins, HaveTheSameBitsEverywhere) {
  const Scene scene = chains(6);
  const auto act = [](World& world, std::uint32_t turn) {
    if (turn % 4 == 0) world.join({.a = (7 * turn + 3) % 42, .b = (7 * turn + 19) % 42});
    if (turn % 4 == 2) world.cut(36 + turn / 4);
    world.step(frame);
  };
  for (const Method method : {Method::direct, Method::relax}) {
    World straight(scene, {.method = method, .tensions = true, .isa = Isa::scalar, .threads = 1});
    for (std::uint32_t turn = 0; turn < 16; ++turn) act(straight, turn);
    for (const Isa isa : all_isas())
      for (const unsigned threads : {1u, 2u}) {
        if (!is_supported(isa)) continue;
        World world(scene, {.method = method, .tensions = true, .isa = isa, .threads = threads});
        for (std::uint32_t turn = 0; turn < 3; ++turn) act(world, turn);
        const test::Snapshot saved = test::snapshot_of(world);
        for (std::uint32_t turn = 3; turn < 9; ++turn) act(world, turn);
        world.restore(saved);
        for (std::uint32_t turn = 3; turn < 16; ++turn) act(world, turn);
        EXPECT_EQ(world.state_hash(), straight.state_hash()) << to_string(isa) << ' ' << threads;
        EXPECT_EQ(test::snapshot_of(world), test::snapshot_of(straight));
      }
  }
}

// A snapshot has what waits, and another world of the scene goes on from it.
TEST(Joins, WaitInSnapshots) {
  const Scene scene = chains(3);
  World world(scene, {.tensions = true, .threads = 1}), other(scene, {.tensions = true, .threads = 1});
  test::run(world, frame, 4);
  const Handle<Rod> joined = world.join({.a = 6, .b = 13, .law = {.strength = 1e4}});
  other.restore(test::snapshot_of(world));
  EXPECT_EQ(other.number(joined), 18u);
  for (World* const each : {&world, &other}) test::run(*each, frame, 8);
  EXPECT_EQ(world.state_hash(), other.state_hash());
  EXPECT_EQ(world.tension(18), other.tension(18));
  EXPECT_NE(world.tension(18), 0);
  World third(scene, {.tensions = true, .threads = 1});
  third.restore(test::snapshot_of(world));
  for (World* const each : {&world, &third}) test::run(*each, frame, 8);
  EXPECT_EQ(world.state_hash(), third.state_hash());
}

// Additions may be joined and removed as one, and what waits ends with them.
TEST(Joins, EndWithWhatTheyJoin) {
  World world(chains(1), {.threads = 1});
  const std::uint32_t first = world.add(chains(1, 1)).particle, second = world.add(chains(1, 2)).particle;
  const Handle<Rod> joined = world.join({.a = first + 6, .b = second + 6});
  test::run(world, frame, 3);
  EXPECT_EQ(world.info().islands, 2u);
  world.remove(first + 3);
  EXPECT_EQ(world.info().islands, 1u);
  EXPECT_FALSE(world.has(joined));
  EXPECT_FALSE(world.handle<Particle>(second + 2));
  const std::uint32_t third = world.add(chains(1, 3)).particle;
  const Handle<Rod> waiting = world.join({.a = 3, .b = third + 3});
  world.remove(third + 1);
  EXPECT_FALSE(world.has(waiting));
  const Handle<Rod> again = world.join({.a = 3, .b = 6});
  EXPECT_TRUE(world.has(again));
  world.cut(again.number);
  EXPECT_FALSE(world.has(again));
  test::run(world, frame, 3);
  World other(chains(1), {.threads = 1});
  other.restore(test::snapshot_of(world));
  for (World* const each : {&world, &other}) test::run(*each, frame, 3);
  EXPECT_EQ(world.state_hash(), other.state_hash());
}

// A hanging load whose rope is cut hangs on by the rod that it was joined by in the same step.
TEST(Joins, CarryWhatIsCutOff) {
  Scene scene;
  scene.gravity = {0, -10, 0};
  scene.particles = {fixed({0, 0, 0}), movable({0, -1, 0}, 2), fixed({0, 1, 0})};
  scene.rods = {{.a = 0, .b = 1}};
  World world(scene, {.tensions = true, .threads = 1});
  test::run(world, frame, 3);
  const Handle<Rod> rod = world.join({.a = 2, .b = 1});
  world.cut(0);
  test::run(world, frame, 30);
  EXPECT_LE(norm(world.position(1) - Vec3{0, -1, 0}), 1e-12);
  EXPECT_NEAR(world.tension(rod.number), 20, 1e-9);
  EXPECT_NEAR(world.reaction(2).y, 20, 1e-9);
  EXPECT_NEAR(world.reaction(0).y, 0, 1e-9);
  world.set_length(rod.number, 1.9);
  world.step(frame);
  EXPECT_NEAR(world.position(1).y, -0.9, 1e-9);
}

TEST(Joins, AreRefusedWithAReason) {
  Scene scene = chains(2);
  for (const double x : {5, 6}) scene.particles.push_back(movable({x, 0, 0}));
  scene.springs.push_back({.a = point_at(14), .b = point_at(15), .stiffness = 1});
  World world(scene, {.threads = 1});
  const Handle<Particle> gone = world.handle<Particle>(world.add(chains(1)).particle + 1);
  world.remove(gone.number);
  const test::Snapshot before = test::snapshot_of(world);
  expect_refusal("particle 17: was removed", [&] { world.join(gone, world.handle<Particle>(3)); });
  expect_refusal("particle 99: unknown", [&] { world.join({.a = 99, .b = 3}); });
  expect_refusal("both ends are particle 3", [&] { world.join({.a = 3, .b = 3}); });
  expect_refusal("(particles 0 and 7) are fixed", [&] { world.join({.a = 0, .b = 7}); });
  expect_refusal("rod 2: joins particles 3 and 2 already", [&] { world.join({.a = 3, .b = 2}); });
  expect_refusal("is 9 m long, and its ends", [&] { world.join({.a = 3, .b = 10, .length = 9}); });
  expect_refusal("slowed by air", [&] { world.join({.a = 3, .b = 10, .mass = 1, .linear_drag = 1}); });
  expect_refusal("rod 0: length is negative", [&] { world.join({.a = 3, .b = 10, .length = -1}); });
  EXPECT_TRUE(test::snapshot_of(world) == before);
  const Handle<Rod> waiting = world.join({.a = 3, .b = 10});
  expect_refusal("is joined in the next step", [&] { world.set_length(waiting.number, 1); });
  expect_refusal("joins particles 10 and 3 already", [&] { world.join({.a = 10, .b = 3}); });
  const std::uint32_t particle = 3;
  const Vec3 x = world.position(3) + Vec3{0, 1, 0}, v{};
  expect_refusal("is joined in the next step, ", [&] { world.teleport({&particle, 1}, {&x, 1}, {&v, 1}); });
  world.step(frame);
  EXPECT_EQ(world.info().islands, 2u);
}

}  // namespace
}  // namespace plumb::PLUMB_TEST_FILE
