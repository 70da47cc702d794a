// Edits and snapshots of what moves: speeds, reactions and problems are those of the motion that follows.

#include <gtest/gtest.h>

#include <cmath>
#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "plumb/settings.hpp"
#include "plumb/world.hpp"
#include "scenes/generators/generators.hpp"
#include "support/figures.hpp"
#include "support/refusals.hpp"

namespace plumb::PLUMB_TEST_FILE {
namespace {

constexpr double frame = 1.0 / 60;
constexpr Gradient gradients[] = {Gradient::new_, Gradient::old, Gradient::mid};

/// A rod of 1 m that moves along itself at 1 m/s, far from everything and without weight.
Scene flying_rod() {
  Scene scene;
  scene.gravity = {};
  scene.particles = {{.position = {0, 0, 0}, .velocity = {1, 0, 0}, .mass = 1},
                     {.position = {1, 0, 0}, .velocity = {1, 0, 0}, .mass = 1}};
  scene.rods = {{.a = 0, .b = 1}};
  return scene;
}

TEST(EditedMotion, StopsAtOnceWhereAParticleIsFixed) {
  for (const Gradient gradient : gradients) {
    World world(flying_rod(), {.method = Method::direct, .gradient = gradient});
    world.step(frame);
    world.fix(0);
    world.step(frame);  // gradient new has the mean velocity of this one
    for (int i = 0; i < 4; ++i) {
      world.step(frame);
      EXPECT_LE(norm(world.velocity(1)), 1e-9) << to_string(gradient) << ", step " << i;
    }
  }
}

TEST(EditedMotion, GoesOnWhereAnAnchorGoesOn) {
  for (const Gradient gradient : gradients) {
    World world(flying_rod(), {.method = Method::direct, .gradient = gradient});
    world.step(frame);
    world.fix(0);
    for (int i = 1; i < 6; ++i) {
      world.move_anchor(0, {(i + 1) * frame, 0, 0});
      world.step(frame);
      EXPECT_LE(norm(world.velocity(1) - Vec3{1, 0, 0}), 1e-9) << to_string(gradient) << ", step " << i;
    }
  }
}

TEST(EditedMotion, ForgetsWhereAnAnchorWasToGoThatIsNoneAfterAll) {
  test::for_jointed_settings([](const Settings& settings) {
    World world(test::crate({0, 2, 0}), settings), untouched(test::crate({0, 2, 0}), settings);
    world.fix(0);
    world.move_anchor(0, {0, 3, 0});
    world.free(0);
    for (World* const each : {&world, &untouched})
      for (int i = 0; i < 3; ++i) each->step(frame);
    EXPECT_EQ(world.state_hash(), untouched.state_hash());
  });
}

TEST(EditedMotion, RefusesToFreeWhatWasPulledOffItsRod) {
  Scene scene = flying_rod();
  for (Particle& particle : scene.particles) particle.velocity = {};
  scene.particles[0].fixed = true;
  World world(scene, {.method = Method::direct});
  world.fix(1);
  world.move_anchor(1, {1.01, 0, 0});
  world.step(frame);
  EXPECT_EQ(test::refusal([&] { world.free(1); }),
            "particle 1: cannot be free, since rod 0 is 1 m long, and its ends are 1.01 m apart");
  world.move_anchor(1, {1, 0, 0});
  world.step(frame);
  world.free(1);
  world.step(frame);
}

// A rod that got two fixed ends in the step that was to change its length never did, and neither free() nor
// set_length() helped.
TEST(EditedMotion, RefusesToFixBothEndsOfWhatChangesItsLength) {
  Scene scene = flying_rod();
  scene.particles[0].fixed = true;
  for (Particle& particle : scene.particles) particle.velocity = {};
  for (const Method method : {Method::direct, Method::relax}) {
    World world(scene, {.method = method});
    const auto fix = [&] { world.fix(1); };
    const auto set_length = [&] { world.set_length(0, 1.1); };
    set_length();
    EXPECT_EQ(
        test::refusal(fix),
        "particle 1: cannot be fixed, since rod 0 changes its length in the next step, and its other end "
        "is fixed");
    world.set_length(0, 1);
    fix();
    EXPECT_EQ(test::refusal(set_length),
              "rod 0: its length cannot change, since both its ends are fixed in the next step");
    world.step(frame);
    EXPECT_EQ(test::refusal(set_length), "rod 0: its length cannot change, since both its ends are fixed");
    world.free(1);
    world.step(frame);
    for (int i = 0; i < 4; ++i) {
      set_length();
      world.step(frame);
    }
    EXPECT_NEAR(norm(world.position(1) - world.position(0)), 1.1, 1e-3);
    fix();
    world.step(frame);
    EXPECT_EQ(test::refusal(set_length), "rod 0: its length cannot change, since both its ends are fixed");
  }
}

TEST(EditedMotion, TeleportsTakeOutWhatStretchesRods) {
  for (const Gradient gradient : gradients) {
    World world(flying_rod(), {.method = Method::direct, .gradient = gradient});
    world.step(frame);
    const std::uint32_t particles[] = {0, 1};
    const Vec3 positions[] = {{5, 0, 0}, {6, 0, 0}};
    const Vec3 velocities[] = {{0, 1, 0}, {2, -1, 0}};
    world.teleport(particles, positions, velocities);
    for (int i = 0; i < 4; ++i) {
      const Vec3 way = world.position(1) - world.position(0);
      EXPECT_LE(std::abs(dot(way, world.velocity(1) - world.velocity(0))), 0.04)
          << to_string(gradient) << ", step " << i;
      // Equal masses have kept their momentum.
      EXPECT_LE(norm(world.velocity(0) + world.velocity(1) - Vec3{2, 0, 0}), 1e-9) << to_string(gradient);
      world.step(frame);
    }
  }
}

/// Three rods that hang from an anchor, `count` times, or with a triangle in them.
Scene wound(std::uint32_t count, bool has_loop) {
  Scene scene;
  for (std::uint32_t k = 0; k < count; ++k)
    for (std::uint32_t i = 0; i <= 3; ++i) {
      scene.particles.push_back({.position = {0.3 * i, 0, 0.5 * k}, .mass = 1, .fixed = i == 0});
      if (i > 0) scene.rods.push_back({.a = 4 * k + i - 1, .b = 4 * k + i});
    }
  if (!has_loop) return scene;
  scene.particles.push_back({.position = {0.45, 0.3, 0}, .mass = 1});
  for (const std::uint32_t end : {1u, 2u}) scene.rods.push_back({.a = end, .b = 4});
  return scene;
}

// A rod that is wound is wound on where its island is put elsewhere at rest, and its end reads that speed. So
// it does in a world that is restored, bit for bit, and gradient mid does not swing about it.
// A crate lies on two bars of fixed particles, which go away from under it, or down.
TEST(EditedMotion, TeleportsOfAnchorsWakeWhatLiesOnThem) {
  Scene scene;
  scene.planes.push_back({});
  for (const double z : {-0.1, 0.1}) {
    const auto first = static_cast<std::uint32_t>(scene.particles.size());
    for (const double x : {-0.5, 0.5}) scene.particles.push_back({.position = {x, 1, z}, .fixed = true});
    scene.capsules.push_back({.a = point_at(first), .b = point_at(first + 1), .radius = 0.05});
  }
  MassProperties box = solid_box(1, {0.2, 0.2, 0.2});
  box.center = {0, 1.15, 0};
  const std::uint32_t body = add_body(scene, box);
  scene.hulls.push_back(box_on_body(body, {.center = box.center, .half_size = {0.1, 0.1, 0.1}}));
  for (const Method method : {Method::automatic, Method::relax})
    for (const Vec3 by : {Vec3{0, 0, 3}, Vec3{0, -0.5, 0}}) {
      World world(scene, {.method = method, .substeps = 4});
      StepReport report = world.step(1.0 / 60);
      for (int i = 0; i < 300 && report.awake_islands > 0; ++i) report = world.step(1.0 / 60);
      ASSERT_EQ(report.awake_islands, 0u);
      const double before = world.position(scene.bodies[body].particles[0]).y;
      std::vector<Vec3> to;
      for (std::uint32_t i = 0; i < 4; ++i) to.push_back(scene.particles[i].position + by);
      world.teleport(std::vector<std::uint32_t>{0, 1, 2, 3}, to, std::vector<Vec3>(4));
      for (int i = 0; i < 60; ++i) world.step(1.0 / 60);
      EXPECT_LT(world.position(scene.bodies[body].particles[0]).y, before - 0.4) << to_string(method);
    }
}

TEST(EditedMotion, TeleportsOfAnchorsWakeWhatHangsFromThem) {
  Scene scene;
  scene.planes.push_back({.offset = -10});
  scene.particles = {{.fixed = true}, {.position = {0, -1, 0}, .mass = 1}};
  scene.rods.push_back({.a = 0, .b = 1, .law = {.stiffness = 1e3, .damping = 100}});
  scene.capsules.push_back({.a = point_at(1), .b = point_at(1), .radius = 0.05});
  for (const Method method : {Method::automatic, Method::relax}) {
    World world(scene, {.method = method, .substeps = 4});
    StepReport report = world.step(1.0 / 60);
    for (int i = 0; i < 600 && report.awake_islands > 0; ++i) report = world.step(1.0 / 60);
    ASSERT_EQ(report.awake_islands, 0u);
    world.teleport(std::vector<std::uint32_t>{0}, std::vector<Vec3>{{0, 0.3, 0}}, std::vector<Vec3>(1));
    for (int i = 0; i < 300; ++i) world.step(1.0 / 60);
    // The weight stretches the rod by 9.81/1e3 m, and what is slow sleeps.
    EXPECT_NEAR(world.position(1).y, -0.7 - 0.00981, 2e-3) << to_string(method);
  }
}

TEST(EditedMotion, TeleportsKeepTheSpeedOfWinding) {
  constexpr double speed = 0.6;
  for (const auto& [count, has_loop] : {std::pair{1u, false}, {3u, false}, {1u, true}})
    for (const Gradient gradient : gradients)
      for (const Precision precision : {Precision::single, Precision::double_}) {
        SCOPED_TRACE(std::string(to_string(gradient)) + " " + std::to_string(count));
        const Scene scene = wound(count, has_loop);
        const Settings settings{.method = Method::direct, .precision = precision, .gradient = gradient};
        World world(scene, settings);
        const auto wind = [&](World& of, int i) {
          of.set_length(0, 0.3 + speed * frame * i);
          of.step(frame);
        };
        for (int i = 1; i <= 20; ++i) wind(world, i);
        const auto rate = [&](const World& of) {
          const Vec3 way = of.position(1) - of.position(0);
          return dot(way, of.velocity(1)) / norm(way);
        };
        std::vector<std::uint32_t> particles;
        std::vector<Vec3> positions;
        for (std::uint32_t i = 0; i < scene.particles.size(); ++i) {
          if (i >= 4 && !has_loop) continue;
          particles.push_back(i);
          positions.push_back(world.position(i) + Vec3{1, 0, 0});
        }
        world.teleport(particles, positions, std::vector<Vec3>(particles.size()));
        EXPECT_NEAR(rate(world), speed, 1e-6);
        std::vector<std::byte> kept(world.snapshot_size());
        world.save(kept);
        World other(scene, settings);
        other.restore(kept);
        for (std::uint32_t i = 0; i < scene.particles.size(); ++i)
          EXPECT_EQ(world.velocity(i), other.velocity(i)) << i;
        for (World* const each : {&world, &other}) wind(*each, 21);
        EXPECT_NEAR(rate(world), speed, 0.01);
        EXPECT_EQ(world.state_hash(), other.state_hash());
      }
}

TEST(EditedMotion, AnchorsKeepTheirSpeedInReactions) {
  Scene scene = flying_rod();
  scene.particles[0].fixed = true;
  scene.rods[0].mass = 0.5;
  World world(scene, {.method = Method::direct, .tensions = true});
  world.fix(1);
  for (int i = 1; i < 6; ++i) {
    world.move_anchor(0, {i * frame, 0, 0});
    if (i < 4) world.move_anchor(1, {1 + i * frame, 0, 0});
    if (i == 4) world.free(1);
    world.step(frame);
    if (i >= 4) {
      EXPECT_LE(norm(world.reaction(0)), 1e-9) << "step " << i;
    }
  }
}

TEST(Problems, AreListedOfSmallNetsAndOfThoseThatThreadsShare) {
  for (const std::uint32_t size : {20u, 80u}) {
    World world(scenes::make_net(size, size), {.method = Method::relax, .events = true, .threads = 2});
    world.step(frame);
    EXPECT_TRUE(world.problems(1e9).empty());
    world.set_force(size * size / 2, {0, 1e300, 0});
    bool is_told = false;
    for (int i = 0; i < 3 && !is_told; ++i) {
      const bool froze = world.step(frame).frozen_islands > 0;
      ASSERT_EQ(froze, !world.problems(1e9).empty()) << size;
      ASSERT_EQ(froze, !world.events().empty()) << size;
      is_told = froze;
    }
    EXPECT_TRUE(is_told) << size;
  }
}

TEST(Problems, EndWhereAnIslandSleeps) {
  Scene scene = scenes::make_chain(6, 0.1, 1);
  for (std::uint32_t i = 0; i < scene.particles.size(); ++i) scene.particles[i].position = {0, -0.1 * i, 0};
  World world(scene, {.method = Method::direct, .accuracy = 1e-9, .most_work = 1});
  bool had_some = false;
  int steps = 0;
  for (; steps < 120; ++steps) {
    const StepReport report = world.step(frame);
    if (report.awake_islands == 0) break;
    had_some = had_some || !world.problems().empty();
  }
  EXPECT_TRUE(had_some) << "or this test tests nothing";
  ASSERT_LT(steps, 120);
  world.step(frame);
  EXPECT_TRUE(world.problems().empty());
}

TEST(RestoredLoads, EndWhereAWorldHasNone) {
  Scene scene = flying_rod();
  for (Particle& particle : scene.particles) particle.velocity = {};
  World with(scene), without(scene);
  with.set_load([](const LoadState&, std::span<Vec3> forces) {
    for (Vec3& force : forces) force = {1, 0, 0};
  });
  with.step(frame);
  std::vector<std::byte> bytes(with.snapshot_size());
  with.save(bytes);
  without.restore(bytes);
  without.step(frame);
  const Vec3 velocity = without.velocity(0);
  without.step(frame);
  EXPECT_LE(norm(without.velocity(0) - velocity), 1e-12);
}

// The island stays whole where its rod breaks, and hangs from the rod's fixed end no more once that is freed.
TEST(EditedMotion, FreesWhatABrokenRodHungFrom) {
  Scene scene;
  scene.particles = {{.position = {0, 0, 0}, .fixed = true},
                     {.position = {0.1, 0, 0}, .mass = 1},
                     {.position = {0.2, 0, 0}, .mass = 1},
                     {.position = {0.29, 0, 0}, .mass = 1, .fixed = true}};
  scene.rods = {{.a = 0, .b = 1, .length = 0.1},
                {.a = 1, .b = 2, .length = 0.1},
                {.a = 2, .b = 3, .length = 0.1, .law = {.strength = 0.5}}};
  for (const Method method : {Method::direct, Method::relax}) {
    World world(scene, {.method = method, .substeps = 4, .threads = 1});
    for (int i = 0; i < 10; ++i) world.step(frame);
    ASSERT_TRUE(world.is_broken(2));
    world.free(3);
    for (int i = 0; i < 30; ++i) world.step(frame);
    EXPECT_NEAR(world.position(3).y, -0.5 * 9.81 * 0.25, 0.02) << to_string(method);
  }
}

// The rods break in the step before, and nobody knows it when the anchor is freed.
TEST(EditedMotion, FreesWhatHungFromARodThatHasJustBroken) {
  Scene scene;
  scene.particles = {{.position = {-0.1, 0, 0}, .fixed = true},
                     {.position = {0, -0.02, 0}, .mass = 0.1},
                     {.position = {0.1, 0, 0}, .mass = 0.1, .fixed = true}};
  scene.rods = {{.a = 0, .b = 1, .law = {.strength = 1}}, {.a = 1, .b = 2, .law = {.strength = 1}}};
  for (const Gradient gradient : gradients) {
    World world(scene, {.method = Method::direct, .gradient = gradient, .substeps = 4});
    ASSERT_EQ(world.step(frame).broken_rods, 2u);
    const Vec3 at = world.position(1);
    const double speed = world.velocity(1).y;
    world.free(2);
    world.step(frame);
    EXPECT_LT(world.position(2).y, -1e-3) << to_string(gradient);
    EXPECT_NEAR(world.velocity(1).y, speed - 9.81 * frame, gradient == Gradient::new_ ? 0.1 : 1e-9)
        << to_string(gradient);
    EXPECT_LT(norm(world.position(1) - at), 0.02) << to_string(gradient);
  }
}

}  // namespace
}  // namespace plumb::PLUMB_TEST_FILE
