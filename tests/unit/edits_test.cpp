// What programs may change of a world while it runs.

#include "step/breaks/edits.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>
#include <span>
#include <string>
#include <vector>

#include "support/edited_worlds.hpp"
#include "support/refusals.hpp"
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
void add_chain(Scene& scene, double x, std::uint32_t rods) {
  const auto first = static_cast<std::uint32_t>(scene.particles.size());
  scene.particles.push_back(fixed({x, 0, 0}));
  for (std::uint32_t i = 1; i <= rods; ++i) {
    scene.particles.push_back(movable({x + 0.06 * i, -0.08 * i, 0}));
    scene.rods.push_back({.a = first + i - 1, .b = first + i});
  }
}

Scene chains(std::uint32_t count, std::uint32_t rods) {
  Scene scene;
  for (std::uint32_t i = 0; i < count; ++i) add_chain(scene, i, rods);
  return scene;
}

Vec3 momentum(const Scene& scene, const World& world, std::uint32_t first, std::uint32_t end) {
  Vec3 sum;
  for (std::uint32_t i = first; i < end; ++i) sum += scene.particles[i].mass * world.velocity(i);
  return sum;
}

TEST(Edits, AreNoneUntilOrdered) {
  detail::Edits edits;
  EXPECT_FALSE(edits.any());
  edits.masses.emplace_back(3, 2.0);
  EXPECT_TRUE(edits.any());
  EXPECT_FALSE(edits == detail::Edits{});
}

// --- Cuts

// What hangs from the rod falls with its momentum, and the rest hangs on.
TEST(Cuts, KeepMomentum) {
  const Scene scene = chains(1, 12);
  for_methods([&](const Settings& settings) {
    World world(scene, settings);
    test::run(world, frame, 30);
    const double rounding = settings.precision == Precision::single ? 1e-5 : 1e-12;
    const std::vector<Vec3> x = test::positions_of(world), v = test::velocities_of(world);
    const Vec3 before = momentum(scene, world, 6, 13);
    EXPECT_FALSE(world.is_broken(5));
    world.cut(5);
    EXPECT_TRUE(world.is_broken(5));
    EXPECT_EQ(test::positions_of(world), x);
    EXPECT_EQ(test::velocities_of(world), v);
    const StepReport report = world.step(frame);
    EXPECT_EQ(report.awake_islands, 2u);
    EXPECT_EQ(report.broken_rods, 0u);
    EXPECT_EQ(report.unsolved, 0u);
    EXPECT_LE(norm(momentum(scene, world, 6, 13) - before - 7 * frame * gravity), rounding * norm(before));
    EXPECT_TRUE(world.is_broken(5));
    EXPECT_GT(norm(world.position(6) - world.position(5)), 0.1 + 1e-6);
  });
}

// A short step moves particles by their velocities alone, and its impulses are those of weight and rods.
TEST(Cuts, MakeNothingJump) {
  const Scene scene = chains(1, 12);
  for_methods([&](const Settings& settings) {
    // What sweeps leave, and what gradients leave along rods, shows the more, the shorter the step.
    if (settings.precision == Precision::single || settings.method == Method::relax ||
        settings.gradient != Gradient::mid)
      return;
    World world(scene, settings);
    test::run(world, frame, 30);
    const std::vector<Vec3> x = test::positions_of(world), v = test::velocities_of(world);
    world.cut(5);
    constexpr double dt = 1e-5;
    world.step(dt);
    for (std::uint32_t i = 0; i < x.size(); ++i) {
      EXPECT_LE(norm(world.position(i) - x[i] - dt * v[i]), 1e-2 * dt) << i;
      EXPECT_LE(norm(world.velocity(i) - v[i]), 1e-2) << i;
    }
  });
}

// The last of nine chains fills all lanes of the second vector alone.
TEST(Cuts, LeaveOthersTheirBits) {
  const Scene scene = chains(9, 8);
  for (const std::vector<std::uint32_t>& ropes : {std::vector<std::uint32_t>{4}, {8}, {2, 8, 0}})
    for (const Method method : {Method::automatic, Method::direct, Method::relax}) {
      const Settings settings{.method = method, .threads = 1};
      World world(scene, settings), other(scene, settings);
      test::run(world, frame, 20);
      test::run(other, frame, 20);
      for (const std::uint32_t rope : ropes) {
        world.cut(8 * rope + 2);
        test::run(world, frame, 20);
        test::run(other, frame, 20);
      }
      for (std::uint32_t i = 0; i < scene.particles.size(); ++i)
        if (std::find(ropes.begin(), ropes.end(), i / 9) == ropes.end()) {
          EXPECT_EQ(world.position(i), other.position(i)) << i;
          EXPECT_EQ(world.velocity(i), other.velocity(i)) << i;
        }
    }
}

// Several cuts of one island before a step make all of its parts, at once; a second cut of a rod is none.
TEST(Cuts, BeforeOneStepAreOne) {
  const Scene scene = chains(2, 12);
  World world(scene, {.tensions = true, .threads = 1});
  test::run(world, frame, 5);
  for (const std::uint32_t rod : {7u, 3u, 3u, 0u, 14u}) world.cut(rod);
  EXPECT_EQ(world.step(frame).awake_islands, 5u);
  world.cut(3);
  EXPECT_EQ(world.step(frame).awake_islands, 5u);
  EXPECT_EQ(world.tension(3), 0);
  EXPECT_EQ(world.reaction(0), Vec3{});  // nothing hangs from it
  EXPECT_GT(world.reaction(13).y, 0);
  EXPECT_TRUE(world.problems().empty());
  world.set_length(3, 0.05);  // it is out, and nothing happens
  world.move_anchor(0, {0, 1, 0});
  world.step(frame);
  EXPECT_EQ(world.position(0), (Vec3{0, 1, 0}));
}

// A rod of a loop leaves one island, and one whose mass joins its ends goes on without a pull.
TEST(Cuts, MayLeaveOneIsland) {
  Scene ring = chains(1, 6);
  ring.rods.push_back({.a = 6, .b = 1});
  World world(ring, {.threads = 1});
  test::run(world, frame, 5);
  world.cut(2);
  EXPECT_EQ(world.step(frame).awake_islands, 1u);
  test::run(world, frame, 20);
  EXPECT_GT(norm(world.position(3) - world.position(2)), 0.11);
  EXPECT_TRUE(world.problems().empty());

  Scene heavy = chains(1, 6);
  for (Rod& rod : heavy.rods) rod.mass = 0.2;
  World joined(heavy, {.mass = MassModel::consistent, .tensions = true, .threads = 1});
  joined.step(frame);
  joined.cut(2);
  EXPECT_EQ(joined.step(frame).awake_islands, 1u);
  test::run(joined, frame, 10);
  EXPECT_EQ(joined.tension(2), 0);
  EXPECT_GT(norm(joined.position(3) - joined.position(2)), 0.1 + 1e-6);
}

TEST(Cuts, EndBendsAndTwistsWithTheirRods) {
  Scene scene = chains(1, 10);
  for (std::uint32_t i = 1; i < 10; ++i)
    scene.bends.push_back({.a = i - 1, .b = i, .c = i + 1, .stiffness = 0.1});
  scene.twists = {{.particles = {3, 4, 5, 6}, .stiffness = 0.1, .angle = 1}};
  World world(scene, {.threads = 1});
  test::run(world, frame, 5);
  expect_refusal("rod 8: twist 0 is of its island", [&] { world.cut(8); });
  world.cut(4);
  EXPECT_EQ(world.step(frame).awake_islands, 2u);
  EXPECT_EQ(world.twist(0), 0);
  world.cut(8);
  EXPECT_EQ(world.step(frame).awake_islands, 3u);
}

TEST(Cuts, WakeWhatSleeps) {
  Scene scene = chains(2, 4);
  for (std::uint32_t i = 0; i < 10; ++i)
    scene.particles[i].position = {double{1} * (i / 5), -0.1 * (i % 5), 0};
  for (const Method method : {Method::direct, Method::relax}) {
    Settings settings{.method = method, .gradient = Gradient::new_, .threads = 1};
    if (method == Method::relax) settings.stop.sweeps = 200;
    World world(scene, settings);
    StepReport last;
    for (int i = 0; i < 300; ++i) last = world.step(frame);
    ASSERT_EQ(last.awake_islands, 0u);
    world.cut(2);
    EXPECT_GE(world.step(frame).awake_islands, 1u);
    EXPECT_LT(world.step(frame).awake_islands, 3u);
    EXPECT_LT(world.velocity(4).y, -0.9 * 9.81 * frame);
    EXPECT_EQ(world.velocity(9), Vec3{});
  }
}

TEST(Cuts, AreRefusedWithAReason) {
  Scene scene = chains(2, 4);
  World world(scene, {.threads = 1});
  expect_refusal("rod 8: unknown", [&] { world.cut(8); });
  Scene shapes = scene;
  shapes.capsules.push_back({.a = point_at(1), .b = point_at(2), .radius = 0.01});
  World touching(shapes, {.threads = 1});
  touching.cut(6);
  EXPECT_EQ(touching.step(frame).awake_islands, 3u);
  Scene reel = scene;
  for (std::uint32_t i = 0; i < 5; ++i) reel.particles[i].position = {0, -0.1 * i, 0};
  reel.reels = {{.particles = {0, 1, 2, 3}}};
  World reeled(reel, {.threads = 1});
  expect_refusal("rod 3: reel 0 is of its island", [&] { reeled.cut(3); });
}

// --- Gravity

// A world whose gravity changes falls as one that had it from the start, but for what a substep knew.
TEST(Gravity, MayChange) {
  Scene scene = chains(3, 6);
  Scene other = scene;
  other.gravity = {3, 1, -2};
  for_methods([&](const Settings& settings) {
    World world(scene, settings), twin(other, settings);
    world.set_gravity(other.gravity);
    EXPECT_EQ(world.velocity(3), Vec3{});
    test::run(world, frame, 20);
    test::run(twin, frame, 20);
    const double rounding = settings.precision == Precision::single ? 1e-3 : 1e-8;
    EXPECT_LE(rms_distance(test::positions_of(world), test::positions_of(twin)), rounding);
  });
}

// Forces stay beside it, and the momentum of what flies changes by it at once.
TEST(Gravity, ActsFromTheNextStepOn) {
  Scene scene = chains(1, 6);
  scene.particles[0] = movable({0, 0, 0});
  for_methods([&](const Settings& settings) {
    World world(scene, settings);
    world.set_force(3, {0, 0, 5});
    test::run(world, frame, 10);
    const Vec3 before = momentum(scene, world, 0, 7);
    world.set_gravity({1, 2, 3});
    EXPECT_EQ(momentum(scene, world, 0, 7), before);
    test::run(world, frame, 10);
    const Vec3 gained = momentum(scene, world, 0, 7) - before;
    const Vec3 due = 10 * frame * (7 * Vec3{1, 2, 3} + Vec3{0, 0, 5});
    // Velocities of gradient new are means of their substep, which the change is in.
    const bool is_late = settings.gradient == Gradient::new_;
    const double least = settings.precision == Precision::single ? 1e-4 : 1e-10;
    EXPECT_LE(norm(gained - due), (is_late ? 0.05 : least) * norm(due));
  });
}

TEST(Gravity, WakesWhatSleeps) {
  Scene scene = chains(1, 4);
  for (std::uint32_t i = 0; i < 5; ++i) scene.particles[i].position = {0, -0.1 * i, 0};
  World world(scene, {.gradient = Gradient::new_, .tensions = true, .threads = 1});
  test::run(world, frame, 300);
  ASSERT_EQ(world.step(frame).awake_islands, 0u);
  EXPECT_NEAR(world.reaction(0).y, 4 * 9.81, 1e-6);
  world.set_gravity({0, -20, 0});
  EXPECT_EQ(world.step(frame).awake_islands, 1u);
  EXPECT_NEAR(world.reaction(0).y, 4 * 20, 1e-6);
  EXPECT_EQ(test::refusal([&] {
              world.set_gravity({0, std::nan(""), 0});
            }).find("gravity is not finite"),
            0u);
  World old(chains(1, 4), {.method = Method::springs});
  expect_refusal("gravity stays under springs", [&] { old.set_gravity({}); });
}

// --- Teleports

/// Puts a chain of `count` particles from `first` on elsewhere, as it is.
void carry(World& world, std::uint32_t first, std::uint32_t count, Vec3 way) {
  std::vector<std::uint32_t> particles;
  std::vector<Vec3> positions, velocities;
  for (std::uint32_t i = first; i < first + count; ++i) {
    particles.push_back(i);
    positions.push_back(world.position(i) + way);
    velocities.push_back(world.velocity(i));
  }
  world.teleport(particles, positions, velocities);
}

// A rope that is carried 100 m away with its anchor goes on as if it had been there.
TEST(Teleports, AreNoBlow) {
  const Scene scene = chains(2, 8);
  const Vec3 way{60, 80, 0};
  for_methods([&](const Settings& settings) {
    World world(scene, settings), other(scene, settings);
    test::run(world, frame, 20);
    test::run(other, frame, 20);
    carry(world, 0, 9, way);
    EXPECT_EQ(world.position(0), way);
    EXPECT_EQ(world.step(frame).unsolved, 0u);
    other.step(frame);
    test::run(world, frame, 10);
    test::run(other, frame, 10);
    // What is read of displacements, and what sweeps and Newton steps leave, differs by where they begin.
    const bool is_exact = settings.method != Method::relax && settings.gradient != Gradient::new_;
    const double rounding = settings.precision == Precision::single ? 2e-2 : is_exact ? 1e-6 : 1e-3;
    for (std::uint32_t i = 0; i < 9; ++i) {
      EXPECT_LE(norm(world.position(i) - way - other.position(i)), rounding) << i;
      EXPECT_LE(norm(world.velocity(i) - other.velocity(i)), 100 * rounding) << i;
    }
    for (std::uint32_t i = 9; i < 18; ++i) EXPECT_EQ(world.position(i), other.position(i));
  });
}

// Velocities are those that are given, and particles that are not listed keep theirs.
TEST(Teleports, SetVelocities) {
  Scene scene = chains(1, 5);
  scene.gravity = {};
  World world(scene, {.threads = 1});
  test::run(world, frame, 2);
  const std::uint32_t last = 5;
  const Vec3 x = world.position(5), along = (1 / 0.1) * (x - world.position(4));
  const Vec3 across{along.y, -along.x, 0};
  world.teleport(std::span(&last, 1), std::span(&x, 1), std::span(&across, 1));
  EXPECT_LE(norm(world.velocity(5) - across), 1e-12);
  EXPECT_LE(norm(world.velocity(4)), 1e-12);
  EXPECT_LE(norm(momentum(scene, world, 1, 6) - across), 1e-12);
  world.step(1e-6);
  EXPECT_LE(norm(momentum(scene, world, 1, 6) - across), 1e-3);
}

TEST(Teleports, AreRefusedWhereRodsDoNotFit) {
  const Scene scene = chains(1, 4);
  World world(scene, {.threads = 1});
  const std::uint32_t particle = 4, twice[] = {4, 4};
  const Vec3 x = world.position(4) + Vec3{0, 0.01, 0}, none{}, both[] = {x, x};
  const std::uint64_t before = world.state_hash();
  expect_refusal("rod 3: is 0.1 m long",
                 [&] { world.teleport(std::span(&particle, 1), std::span(&x, 1), std::span(&none, 1)); });
  expect_refusal("particle 4: is listed twice", [&] { world.teleport(twice, both, both); });
  expect_refusal("teleport: 2 particles cannot", [&] { world.teleport(twice, std::span(&x, 1), both); });
  EXPECT_EQ(world.state_hash(), before);
}

// --- Particles

// A chain that is fixed in the middle has two parts, and is one again when it is freed.
TEST(Particles, MayBeFixedAndFreed) {
  const Scene scene = chains(1, 8);
  for_methods([&](const Settings& settings) {
    World world(scene, settings);
    test::run(world, frame, 10);
    const Vec3 at = world.position(4), v = world.velocity(6);
    world.fix(4);
    EXPECT_EQ(world.step(1e-6).awake_islands, 2u);
    const double rounding = settings.precision == Precision::single ? 1e-5 : 1e-12;
    EXPECT_LE(norm(world.position(4) - at), rounding);
    EXPECT_EQ(world.velocity(4), Vec3{});
    if (settings.method != Method::relax) {
      EXPECT_LE(norm(world.velocity(6)), 2 * norm(v) + 0.1);
    }
    test::run(world, frame, 20);
    EXPECT_LE(norm(world.position(4) - at), rounding);
    world.move_anchor(4, at + Vec3{0, 0, 0.01});
    world.step(frame);
    EXPECT_NEAR(norm(world.position(4) - at), 0.01, 1e-6);
    world.free(4);
    expect_refusal("particle 4: is movable", [&] { world.move_anchor(4, at); });
    const StepReport report = world.step(frame);
    EXPECT_EQ(report.awake_islands, 1u);
    EXPECT_EQ(report.unsolved, 0u);
    test::run(world, frame, 60);
    EXPECT_GT(norm(world.position(4) - at), 0.01);
    EXPECT_TRUE(world.problems(0.02).empty());
  });
}

// A rod whose ends are both fixed pulls nothing, whichever island of its solver it was in.
TEST(Particles, LeaveNoPullBetweenThoseThatAreFixed) {
  const Scene scene = chains(9, 12);
  for_methods([&](Settings settings) {
    settings.tensions = true;
    World world(scene, settings);
    test::run(world, frame, 5);
    for (const std::uint32_t chain : {0u, 4u, 8u})
      for (const std::uint32_t link : {5u, 6u}) world.fix(13 * chain + link);
    test::run(world, frame, 5);
    for (std::uint32_t chain = 0; chain < 9; ++chain)
      for (std::uint32_t link = 0; link < 12; ++link) {
        const bool is_between = chain % 4 == 0 && link == 5;
        EXPECT_EQ(world.tension(12 * chain + link) == 0, is_between) << chain << ' ' << link;
      }
  });
}

// A particle that is let go flies on as its anchor was led, and ropes from one anchor are one island then.
TEST(Particles, GoOnAsTheyWereLed) {
  Scene scene = chains(1, 3);
  scene.gravity = {};
  for (std::uint32_t i = 1; i < 4; ++i) {
    scene.particles.push_back(movable({-0.1 * i, 0, 0}));
    scene.rods.push_back({.a = i == 1 ? 0 : i + 2, .b = i + 3});
  }
  scene.particles[0].mass = 2;
  World world(scene, {.substeps = 4, .threads = 1});
  world.move_anchor(0, {0, 0, 0.02});
  EXPECT_EQ(world.step(frame).awake_islands, 2u);
  Vec3 before = 2 * Vec3{0, 0, 0.02 / frame};
  for (std::uint32_t i = 1; i < 7; ++i) before += world.velocity(i);
  world.free(0);
  world.set_force(0, {0, 3, 0});
  EXPECT_EQ(world.step(frame).awake_islands, 1u);
  Vec3 after = 2 * world.velocity(0) - frame * Vec3{0, 3, 0};
  for (std::uint32_t i = 1; i < 7; ++i) after += world.velocity(i);
  EXPECT_LE(norm(after - before), 1e-12 * norm(before));
}

// Twice the mass hangs twice as heavily, and motion stays as it is.
TEST(Particles, MayChangeTheirMass) {
  Scene scene = chains(2, 4);
  for (std::uint32_t i = 0; i < 10; ++i)
    scene.particles[i].position = {double{1} * (i / 5), -0.1 * (i % 5), 0};
  World world(scene, {.tensions = true, .threads = 1});
  test::run(world, frame, 5);
  const Vec3 v = world.velocity(3);
  world.set_mass(3, 7);
  world.set_mass(3, 3);
  EXPECT_EQ(world.velocity(3), v);
  test::run(world, frame, 10);
  EXPECT_NEAR(world.tension(1), 5 * 9.81, 1e-6);
  EXPECT_NEAR(world.tension(3), 9.81, 1e-6);
  EXPECT_NEAR(world.tension(5), 3 * 9.81, 1e-6);
  EXPECT_NEAR(world.reaction(0).y, 6 * 9.81, 1e-6);
}

TEST(Particles, RefuseEditsWithAReason) {
  Scene scene = chains(2, 4);
  scene.particles[0].mass = std::numeric_limits<double>::infinity();
  scene.tackles.push_back({.particles = {1, 3}, .length = 1, .law = {.one_sided = true}});
  scene.bends.push_back({.a = 5, .b = 6, .c = 7, .stiffness = 1});
  World world(scene, {.threads = 1});
  expect_refusal("particle 0: has no mass to be free", [&] { world.free(0); });
  expect_refusal("particle 1: is of tackle 0", [&] { world.fix(1); });
  world.fix(7);
  expect_refusal("particle 6: cannot be fixed, since both ends of a rod of bend 0 would be",
                 [&] { world.fix(6); });
  world.free(7);
  expect_refusal("particle 99: unknown", [&] { world.fix(99); });
  expect_refusal("particle 2: a mass must be positive", [&] { world.set_mass(2, 0); });
  world.set_mass(0, 1);
  world.free(0);
  world.fix(5);  // it is
  EXPECT_EQ(world.step(frame).awake_islands, 2u);
  EXPECT_LT(world.velocity(0).y, 0);
}

}  // namespace
}  // namespace plumb::PLUMB_TEST_FILE
