// Crates on lifts, belts and bars: what moves with platforms and anchors carries hulls as it does capsules.

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <random>

#include "support/boxes.hpp"
#include "support/ground.hpp"

namespace plumb::PLUMB_TEST_FILE {
namespace {

using test::earth;
using test::frame;

constexpr std::array methods{Method::direct, Method::relax};

Settings settings_of(Method method, std::uint32_t substeps) {
  return {.method = method, .substeps = substeps, .tensions = true, .threads = 1};
}

/// A box on the first platform, 2 m wide, with its top at height 0.
Scene lift(double half_height, Surface surface = {}, Vec3 belt = {}) {
  Scene scene;
  scene.platforms.emplace_back();
  scene.boxes.push_back({.center = {0, -half_height, 0},
                         .half_size = {1, half_height, 1},
                         .surface = surface,
                         .motion = {.platform = 0, .belt = belt}});
  return scene;
}

// Three crates, one on the other, go up by 2 m with a lift that speeds up at 2 m/s² for a second and slows
// down likewise. The lowest is pushed up by the weight of all, and down by that of two. What sweeps leave of
// weights differs from step to step, so that means over half a second count. A relaxed tower is off by up to
// 3 cm, on ground that stands, too, and its weight by 16 % there.
TEST(MovingHulls, RideALiftAsATower) {
  constexpr double mass = 5, faster = 2;
  for (const Method method : methods) {
    const bool is_solved = method == Method::direct;
    for (const std::uint32_t substeps : {1u, 4u}) {
      SCOPED_TRACE(testing::Message() << to_string(method) << ", substeps " << substeps);
      Scene scene = lift(0.1);
      for (const int i : {0, 1, 2}) test::add_box(scene, {0, 0.2 + 0.4 * i, 0}, {0.2, 0.2, 0.2}, mass, {});
      World world(scene, settings_of(method, substeps));
      std::array<double, 3> weights{};  // rising faster, slower, and at rest
      for (int i = 1; i <= 180; ++i) {
        const double t = std::min(2.0, i * frame);
        const double height = t < 1 ? 0.5 * faster * t * t : faster - 0.5 * faster * (2 - t) * (2 - t);
        world.move_platform(0, {.position = {0, height, 0}});
        world.step(frame);
        if ((i - 1) % 60 >= 30) weights[(i - 1) / 60] += world.contact_force(0).y / 30;
        for (const int k : {0, 1, 2})
          EXPECT_LE(norm(test::middle_of(scene, world, k) - Vec3{0, height + 0.2 + 0.4 * k, 0}),
                    is_solved ? 5e-3 : 5e-2)
              << k << ", frame " << i;
      }
      for (const int i : {0, 1, 2})
        EXPECT_NEAR(weights[i], mass * (earth + std::array{faster, -faster, 0.0}[i]),
                    (is_solved ? 0.02 : 0.2) * mass * earth);
    }
  }
}

// A plate 1 cm thick that comes at 10 m/s, 17 cm in a step, and one that a crate falls onto at 31 m/s.
TEST(MovingHulls, DoNotPassThinPlates) {
  for (const Method method : methods)
    for (const std::uint32_t substeps : {1u, 4u})
      for (const double speed : {0.0, 10.0}) {
        SCOPED_TRACE(testing::Message() << to_string(method) << ", substeps " << substeps << ", " << speed);
        Scene scene = lift(0.005);
        test::add_box(scene, {0.03, speed > 0 ? 0.5 : 5, 0}, {0.1, 0.1, 0.1}, 5, {});
        if (speed == 0)
          for (Particle& each : scene.particles) each.velocity = {0, -30, 0};
        World world(scene, settings_of(method, substeps));
        for (int i = 1; i <= 60; ++i) {
          world.move_platform(0, {.position = {0, speed * i * frame, 0}});
          world.step(frame);
        }
        EXPECT_NEAR(test::middle_of(scene, world, 0).y, 0.1 + speed, 1e-3);
      }
}

// Friction mu g brings a crate to the speed of a belt that goes up with a lift.
TEST(MovingHulls, ComeToTheSpeedOfABelt) {
  constexpr double friction = 0.3, belt = 2;
  for (const Method method : methods) {
    Scene scene = lift(0.1, {.friction = friction}, {belt, 0, 0});
    test::add_box(scene, {-0.8, 0.2, 0}, {0.1, 0.2, 0.2}, 5, {.friction = friction});
    World world(scene, settings_of(method, 4));
    for (int i = 1; i <= 45; ++i) {
      world.move_platform(0, {.position = {0, 0.1 * i * frame, 0}});
      world.step(frame);
      const double wanted = std::min(belt, friction * earth * world.time());
      EXPECT_NEAR(test::velocity_of(world, scene.bodies[0]).x, wanted, 0.04) << to_string(method) << ' ' << i;
    }
  }
}

// A wall pushes a crate over the floor, at the wall's speed.
TEST(MovingHulls, ArePushedByAWall) {
  for (const Method method : methods) {
    Scene scene;
    scene.planes.push_back({.surface = {.friction = 0.5}});
    scene.platforms.emplace_back();
    scene.boxes.push_back({.center = {-0.4, 0.5, 0}, .half_size = {0.1, 0.5, 1}, .motion = {.platform = 0}});
    test::add_box(scene, {0, 0.2, 0}, {0.2, 0.2, 0.2}, 5, {.friction = 0.5});
    World world(scene, settings_of(method, 4));
    for (int i = 1; i <= 120; ++i) {
      world.move_platform(0, {.position = {0.5 * i * frame, 0, 0}});
      world.step(frame);
    }
    EXPECT_NEAR(test::middle_of(scene, world, 0).x, 1 - 0.1, 1e-3) << to_string(method);
    EXPECT_NEAR(test::middle_of(scene, world, 0).y, 0.2, 1e-3) << to_string(method);
  }
}

// A plank lies across a bar on two anchors that go up, and comes to rest on it. A relaxed one bends.
TEST(MovingHulls, RideABarOnAnchors) {
  for (const Method method : methods) {
    Scene scene;
    scene.particles = {test::fixed({0, 0, -1}), test::fixed({0, 0, 1})};
    scene.capsules = {{.a = point_at(0), .b = point_at(1), .radius = 0.1}};
    test::add_box(scene, {0, 0.15, 0}, {0.5, 0.05, 0.2}, 5, {});
    World world(scene, settings_of(method, 4));
    for (int i = 1; i <= 120; ++i) {
      for (const double side : {-1.0, 1.0}) world.move_anchor(side < 0 ? 0 : 1, {0, i * frame, side});
      world.step(frame);
    }
    EXPECT_NEAR(test::middle_of(scene, world, 0).y, 2.15, method == Method::direct ? 1e-5 : 3e-3);
    EXPECT_NEAR(world.contact_force(1).y, 5 * earth, 0.05 * earth) << to_string(method);
  }
}

// A plate comes down on a crate until less is left than that is high. The crate is bent, or goes aside by its
// size at most: once it was brought to where nothing presses it, up to 49 m away, in a frame of a tenth of a
// second.
TEST(MovingHulls, ArePressedWhereTheyAre) {
  for (const double speed : {0.05, 0.15, 0.25, 0.5, 0.75, 2.5})
    for (const double half : {0.1, 0.5})
      for (const double turn : {0.0, 0.7}) {
        SCOPED_TRACE(testing::Message() << speed << " m/s, half " << half << ", turned " << turn);
        Scene scene;
        scene.planes.emplace_back();
        scene.platforms.emplace_back();
        scene.boxes.push_back(
            {.center = {0, 2.2 * half + 0.1, 0}, .half_size = {3, 0.1, 3}, .motion = {.platform = 0}});
        MassProperties solid = solid_box(5, 2 * half * Vec3{1, 1, 1});
        solid.center = {0, half, 0};
        const std::uint32_t body = add_body(scene, solid);
        scene.hulls.push_back(box_on_body(body, {.center = solid.center,
                                                 .half_size = half * Vec3{1, 1, 1},
                                                 .orientation = test::turned(turn, {0, 1, 0})}));
        World world(scene, {.threads = 1});
        double farthest = 0;  // m, in a step
        StepReport report;
        for (int i = 1; i <= 180; ++i) {
          const Vec3 before = test::middle_of(scene, world, 0);
          world.move_platform(0, {.position = {0, -std::min(0.6 * half, speed * i * frame), 0}});
          report += world.step(frame);
          farthest = std::max(farthest, norm(test::middle_of(scene, world, 0) - before));
        }
        EXPECT_LT(farthest, 1.5 * half);
        EXPECT_EQ(report.unsolved + report.frozen_islands + report.capped_steps, 0u);
      }
}

// A crane presses a crate against a ceiling. Substeps of that are cut as often, and it moves alike to the
// bit, whether ground moves far away or not.
TEST(MovingHulls, ArePressedAlikeWhateverMovesFarAway) {
  std::array<Vec3, 2> ends;
  std::array<std::uint64_t, 2> halvings{};
  for (const std::size_t moves : {0u, 1u}) {
    Scene scene;
    scene.particles = {test::fixed({0, 3, 0}), test::movable({0, 0.5, 0}, 0.1)};
    scene.rods = {{.a = 0, .b = 1}};
    test::add_box(scene, {0, 0.3, 0}, {0.2, 0.2, 0.2}, 20, {});
    scene.pins.push_back({point_at(1), point_on_body(scene, 0, {0, 0.5, 0})});
    scene.boxes.push_back({.center = {0, 1.2, 0}, .half_size = {1, 0.05, 1}});
    scene.platforms.emplace_back();
    scene.boxes.push_back({.center = {50, 0, 0}, .half_size = {1, 1, 1}, .motion = {.platform = 0}});
    World world(scene, {.threads = 1});
    for (int i = 1; i <= 90; ++i) {
      world.move_anchor(0, {0, 3 + 0.5 * i * frame, 0});
      world.move_platform(0, {.position = {0, 0.1 * static_cast<double>(moves) * i * frame, 0}});
      halvings[moves] += world.step(frame).halvings;
    }
    ends[moves] = world.position(1);
  }
  EXPECT_EQ(ends[0], ends[1]);
  EXPECT_EQ(halvings[0], halvings[1]);
  EXPECT_GT(halvings[0], 256u) << "it is hard to solve";
}

// A door is a box with two corners on anchors, where a bar holds its hinge, too. They do not touch.
TEST(MovingHulls, DoNotTouchTheBarTheyHangOn) {
  Scene scene;
  MassProperties door = solid_box(5, {0.8, 1, 0.1});
  door.center = {0.4, 0.5, 0};
  scene.particles = {test::fixed({0, 0, 0}), test::fixed({0, 1, 0}), test::movable({0.8, 0.5, 0.05}, 1),
                     test::movable({0.8, 0.5, -0.05}, 1)};
  const std::uint32_t body = add_body(scene, {0, 1, 2, 3}, door);
  scene.capsules = {{.a = point_at(0), .b = point_at(1), .radius = 0.1}};
  scene.hulls.push_back(box_on_body(body, {.center = {0.4, 0.5, 0}, .half_size = {0.4, 0.5, 0.05}}));
  World world(scene, settings_of(Method::direct, 4));
  world.set_force(2, {0, 0, 5});
  test::run(world, frame, 60);
  EXPECT_GT(world.position(2).z, 0.1) << "it swings";
  EXPECT_EQ(world.contact_force(0), Vec3{});
}

// Crates lie in a tray that goes where chance says, below 2 m/s, with a bar across that rolls over them. None
// comes out through its floor or its walls, and all stay upright bodies: their rods keep their lengths.
TEST(MovingHulls, StayInTraysThatAreShaken) {
  std::mt19937 random(7);
  std::uniform_real_distribution<double> any(-1, 1);
  for (const Method method : methods)
    for (int run = 0; run < 6; ++run) {
      SCOPED_TRACE(testing::Message() << to_string(method) << ", run " << run);
      Scene scene = lift(0.1);
      for (const double side : {-1.0, 1.0}) {
        scene.boxes.push_back(
            {.center = {side, 0.5, 0}, .half_size = {0.05, 0.5, 1}, .motion = {.platform = 0}});
        scene.boxes.push_back(
            {.center = {0, 0.5, side}, .half_size = {1, 0.5, 0.05}, .motion = {.platform = 0}});
      }
      for (int i = 0; i < 6; ++i)
        test::add_box(scene, {0.6 * (i % 3 - 1), 0.16, 0.4 * (i / 3) - 0.2}, {0.1, 0.15, 0.12}, 2,
                      {.friction = 0.4});
      World world(scene, settings_of(method, 4));
      Vec3 at{};
      Vec3 way{};
      for (int i = 0; i < 180; ++i) {
        if (i % 30 == 0) way = {any(random), 0.5 * any(random), any(random)};
        at += frame * way;
        world.move_platform(0, {.position = at});
        world.step(frame);
        for (std::uint32_t k = 0; k < 6; ++k) {
          const Vec3 inside = test::middle_of(scene, world, k) - at;
          EXPECT_GT(inside.y, 0.09) << k << ", frame " << i;
          EXPECT_LT(std::max(std::abs(inside.x), std::abs(inside.z)), 0.95 - 0.09) << k << ", frame " << i;
        }
      }
    }
}

std::uint64_t hash_of_crates(Isa isa, unsigned threads, Method method) {
  Scene scene = lift(0.1);
  scene.particles = {test::fixed({0, 0.5, -1}), test::fixed({0, 0.5, 1})};
  scene.capsules = {{.a = point_at(0), .b = point_at(1), .radius = 0.1}};
  for (int i = 0; i < 12; ++i)
    test::add_box(scene, {0.5 * (i % 4 - 1.5), 0.7 + 0.3 * (i / 4), 0.1 * (i % 3)}, {0.1, 0.1, 0.1}, 1, {});
  Settings settings = settings_of(method, 2);
  settings.isa = isa;
  settings.threads = threads;
  World world(scene, settings);
  for (int i = 1; i <= 60; ++i) {
    world.move_platform(
        0, {.position = {0, 0.3 * i * frame, 0}, .orientation = test::turned(i * frame, {0, 0.8, 0.6})});
    for (const double side : {-1.0, 1.0}) world.move_anchor(side < 0 ? 0 : 1, {0, 0.5 + i * frame, side});
    world.step(frame);
  }
  return world.state_hash();
}

TEST(MovingHulls, GiveTheSameBitsOnEveryMachine) {
  for (const Method method : methods) {
    const std::uint64_t wanted = hash_of_crates(Isa::scalar, 1, method);
    for (const Isa isa : {Isa::scalar, Isa::sse2, Isa::avx2, Isa::avx512})
      if (is_supported(isa)) {
        EXPECT_EQ(hash_of_crates(isa, 2, method), wanted) << to_string(isa) << ", " << to_string(method);
      }
  }
}

}  // namespace
}  // namespace plumb::PLUMB_TEST_FILE
