// What rests sleeps: it costs nothing, stays where it is to the bit, and wakes as the whole island that it
// is.

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <string>
#include <vector>

#include "scenes/humanoid/humanoid.hpp"
#include "scenes/spec.hpp"
#include "support/bodies.hpp"
#include "support/boxes.hpp"

namespace plumb::PLUMB_TEST_FILE {
namespace {

using test::frame;

/// Balls and a rod that lie on the ground, some 0.1 m apart, and a chain that hangs from an anchor out of
/// their reach. All asleep.
struct Sleepers {
  Scene scene;
  std::uint32_t ball = 0, other_ball = 0, rod = 0, chain = 0, anchor = 0;
};
Sleepers sleepers() {
  Sleepers out;
  Scene& scene = out.scene;
  const Surface surface{.friction = 0.5};
  scene.planes.push_back({.surface = surface});
  out.ball = test::add_ball(scene, {0, 0.1, 0}, 0.1, 1, {}, surface);
  out.other_ball = test::add_ball(scene, {0.5, 0.1, 0}, 0.1, 1, {}, surface);
  out.rod = static_cast<std::uint32_t>(scene.particles.size());
  test::add_capsule_rod(scene, {-0.5, 0.05, -0.5}, {-0.5, 0.05, 0.5}, 2, 0.05, surface);
  out.anchor = static_cast<std::uint32_t>(scene.particles.size());
  scene.particles.push_back(test::fixed({5, 3, 0}));
  out.chain = out.anchor + 1;
  for (std::uint32_t i = 0; i < 3; ++i) {
    scene.particles.push_back(test::movable({5, 2.5 - 0.5 * i, 0}, 1));
    scene.rods.push_back({.a = out.anchor + i, .b = out.anchor + i + 1});
  }
  for (Particle& particle : scene.particles) particle.asleep = true;
  return out;
}

TEST(Sleepers, CostNothingAndDoNotMoveByABit) {
  const Sleepers s = sleepers();
  World world(s.scene, test::body_settings(1, true));
  const std::uint64_t before = world.state_hash();
  const StepReport report = test::run(world, frame, 1000);
  EXPECT_EQ(report.awake_islands, 0u);
  EXPECT_EQ(report.direct_substeps, 0u);
  EXPECT_EQ(world.state_hash(), before);
  for (std::uint32_t i = 0; i < s.scene.particles.size(); ++i)
    EXPECT_EQ(world.position(i), s.scene.particles[i].position) << i;
}

// One is woken; the others sleep on.
TEST(Sleepers, AreWokenByAForce) {
  const Sleepers s = sleepers();
  World world(s.scene, test::body_settings(1, true));
  world.set_force(s.rod, {0, 0, 0});
  EXPECT_EQ(world.step(frame).awake_islands, 1u);
  world.set_force(s.ball, {0, 30, 0});
  EXPECT_EQ(world.step(frame).awake_islands, 2u);
  EXPECT_GT(world.velocity(s.ball).y, 0.1);
  EXPECT_EQ(world.velocity(s.other_ball), Vec3{});
}

TEST(Sleepers, AreWokenByAnAnchorThatMoves) {
  const Sleepers s = sleepers();
  World world(s.scene, test::body_settings(1, true));
  world.move_anchor(s.anchor, {5.1, 3, 0});
  EXPECT_EQ(world.step(frame).awake_islands, 1u);
  for (std::uint32_t i = 0; i < 3; ++i) EXPECT_GT(norm(world.velocity(s.chain + i)), 1e-3) << i;
  EXPECT_EQ(world.velocity(s.ball), Vec3{});
}

// A ball that rolls into the first; that one into the next.
TEST(Sleepers, AreWokenByTouchOneAfterTheOther) {
  Sleepers s = sleepers();
  test::add_ball(s.scene, {-0.35, 0.1, 0}, 0.1, 1, {3, 0, 0}, {.friction = 0, .restitution = 1});
  World world(s.scene, test::body_settings(1, true));
  std::uint32_t most = 0;
  for (int i = 0; i < 60; ++i) most = std::max(most, world.step(frame).awake_islands);
  EXPECT_EQ(most, 3u);
  EXPECT_GT(world.position(s.ball).x, 0.05);
  EXPECT_EQ(world.position(s.rod), s.scene.particles[s.rod].position);
}

// In a step longer than what it takes to fall asleep a ball that is hit may sleep again before it ends; it is
// still one ball, that a force moves as far as friction lets it.
TEST(Sleepers, AreWokenAndSleepAgainInOneLongStep) {
  for (const double dt : {0.49, 0.5, 0.6}) {
    Scene scene;
    const Surface surface{.friction = 0.5};
    scene.planes.push_back({.surface = surface});
    const std::uint32_t ball = test::add_ball(scene, {0, 0.1, 0}, 0.1, 1, {}, surface);
    scene.particles[ball].asleep = true;
    test::add_ball(scene, {-0.25, 0.1, 0}, 0.1, 1, {1, 0, 0}, surface);
    World world(scene, {.method = Method::direct, .substeps = 960, .threads = 1});
    test::run(world, dt, 6);
    const double before = world.position(ball).z;
    world.set_force(ball, {0, 0, 8});
    world.step(dt);
    // Verlet is exact where the acceleration is constant; 3e-14 m of rounding seen.
    EXPECT_NEAR(world.position(ball).z - before, 0.5 * (8 - 0.5 * 9.81) * dt * dt, 1e-12) << dt;
  }
}

// The foot is touched, and the head wakes.
TEST(Sleepers, WakeWholeFigures) {
  Scene scene = scenes::make_humanoid({.body = scenes::BodyType::thin});
  test::add_ball(scene, scene.particles[9].position + Vec3{0.5, 0.1, 0}, 0.05, 2, {-4, 0, 0});
  World world(scene, test::body_settings(1, true));
  EXPECT_EQ(world.step(frame).awake_islands, 1u) << "the ball alone";
  StepReport report;
  for (int i = 0; i < 30 && report.awake_islands < 2; ++i) report = world.step(frame);
  EXPECT_EQ(report.awake_islands, 2u);
  for (std::uint32_t i = 0; i < 10; ++i) EXPECT_NE(world.velocity(i), Vec3{}) << i;
}

// A thousand steps of those who fell asleep by themselves.
TEST(Sleepers, StayWhereTheyFellAsleep) {
  const Scene scene = scenes::load_scene("crowd:humanoids=4,hit=4,body=thin");
  World world(scene, test::body_settings(1, true));
  int steps = 0;
  while ((world.step(frame).awake_islands > 0 || steps == 0) && steps < 1800) ++steps;
  ASSERT_LT(steps, 1800) << "someone never slept";
  const std::uint64_t before = world.state_hash();
  EXPECT_EQ(test::run(world, frame, 1000).awake_islands, 0u);
  EXPECT_EQ(world.state_hash(), before);
}

// To fall asleep and be woken without being touched takes what was left of motion, and nothing else: a rod
// that was dropped aslant, against the same in a world that never sleeps, with as many steps. It would sleep
// again after half a second.
TEST(Sleepers, GoOnAsIfTheyHadStood) {
  for (const Vec3 force : {Vec3{}, Vec3{30, 5, -2}}) {
    Scene scene;
    scene.planes.push_back({});
    test::add_capsule_rod(scene, {-0.5, 0.3, -0.1}, {-0.5, 0.15, 0.5}, 2, 0.05, {.friction = 0.5});
    World sleeps(scene, test::body_settings(1, true)), wakes(scene, test::body_settings());
    std::uint32_t slept = 0;
    for (int i = 0; i < 600 && slept == 0; ++i) {
      slept = sleeps.step(frame).fell_asleep;
      wakes.step(frame);
    }
    ASSERT_EQ(slept, 1u);
    for (std::uint32_t i = 0; i < 2; ++i) {
      EXPECT_EQ(sleeps.position(i), wakes.position(i)) << i;
      EXPECT_EQ(sleeps.velocity(i), Vec3{}) << i;
      EXPECT_LT(norm(wakes.velocity(i)), 1e-5) << i;
    }
    test::run(sleeps, frame, 100);
    for (World* world : {&sleeps, &wakes}) {
      world->set_force(1, force);
      test::run(*world, frame, 25);
    }
    for (std::uint32_t i = 0; i < 2; ++i) EXPECT_LT(norm(sleeps.position(i) - wakes.position(i)), 1e-5) << i;
    if (force != Vec3{}) {
      EXPECT_GT(norm(sleeps.velocity(1)), 1);
    }
  }
}

/// Runs until all sleep, or for half a minute. Returns how long it took, s.
double fall_asleep(World& world) {
  int steps = 1;
  while (world.step(frame).awake_islands > 0 && steps < 1800) ++steps;
  return steps * frame;
}

// What is relaxed sleeps while sweeps still leave it some motion, up to 0.02 m/s.
TEST(Sleepers, ReportNoMotion) {
  for (const char* const spec : {"boxes", "heap:ropes=16", "pile:figures=8", "terrain"}) {
    SCOPED_TRACE(spec);
    const Scene scene = scenes::load_scene(spec);
    World world(scene, {.threads = 1});
    EXPECT_LT(fall_asleep(world), 30);
    for (std::uint32_t i = 0; i < scene.particles.size(); ++i) EXPECT_EQ(world.velocity(i), Vec3{}) << i;
    for (std::uint32_t i = 0; i < scene.bodies.size(); ++i) EXPECT_EQ(world.motion(i), BodyMotion{}) << i;
  }
}

// The slop is half a millimetre. Of an overlap beyond twice that a step takes back a tenth, until it counts
// as rest, and 0.9 to the 30th power of it is left when it sleeps.
TEST(Sleepers, AreOutOfGroundAndEachOther) {
  const Surface rough{.friction = 0.5};
  for (auto& [name, ground] : test::level_grounds(rough))
    for (const double deep : {0.002, 0.01, 0.05}) {
      SCOPED_TRACE(name + ", " + std::to_string(deep));
      Scene scene = ground;
      std::vector<std::uint32_t> boxes;
      for (const double height : {0.1 - deep, 0.3 - 2 * deep})
        boxes.push_back(test::add_box(scene, {0, height, 0}, {0.1, 0.1, 0.1}, 1, rough));
      const std::uint32_t ball = test::add_ball(scene, {1, 0.1 - deep, 0}, 0.1, 1, {}, rough);
      World world(scene, {.threads = 1});
      EXPECT_LT(fall_asleep(world), 2);
      EXPECT_NEAR(test::middle_of(scene, world, boxes[0]).y, 0.1, 6e-4);
      EXPECT_NEAR(test::middle_of(scene, world, boxes[1]).y, 0.3, 1.2e-3);
      EXPECT_NEAR(world.position(ball).y, 0.1, 6e-4);
    }
}

// Sweeps may not find at once what ends all overlaps of a tower. Boxes then yield to each other but not to
// their weight. Each keeps at most twice the slop of 0.5 mm, and is pushed up, not thrown: a box that falls
// by as much as it was too low gets as fast.
TEST(Sleepers, AreOutOfATowerThatBeganInItself) {
  const Surface rough{.friction = 0.5};
  for (const std::uint32_t substeps : {1u, 2u})
    for (const auto& [count, deep] : {std::pair{6, 0.03}, {6, 0.05}, {10, 0.01}, {10, 0.03}}) {
      SCOPED_TRACE(testing::Message() << count << " boxes, " << deep << " m, " << substeps << " substeps");
      Scene scene;
      scene.planes.push_back({.surface = rough});
      for (int i = 0; i < count; ++i)
        test::add_box(scene, {0, 0.1 - deep + i * (0.2 - deep), 0}, {0.1, 0.1, 0.1}, 1, rough);
      World world(scene, {.substeps = substeps, .threads = 1});
      double fastest = 0;
      for (bool awake = true; awake && world.time() < 2.5;) {
        awake = world.step(frame).awake_islands > 0;
        for (std::uint32_t k = 0; k < world.particle_count(); ++k)
          fastest = std::max(fastest, norm(world.velocity(k)));
      }
      EXPECT_LT(world.time(), 2.5);
      EXPECT_LT(fastest, std::sqrt(2 * test::earth * deep));
      for (int i = 0; i < count; ++i)
        EXPECT_NEAR(test::middle_of(scene, world, i).y, 0.1 + 0.2 * i, 1e-3 * (i + 1)) << i;
    }
}

// What has no room to come out goes as far as it can, and sleeps there.
TEST(Sleepers, MayBeSqueezed) {
  const Surface rough{.friction = 0.5};
  for (const double deep : {0.002, 0.01}) {
    Scene scene;
    scene.planes.push_back({.surface = rough});
    scene.planes.push_back({.normal = {0, -1, 0}, .offset = deep - 0.2, .surface = rough});
    test::add_ball(scene, {0, 0.1 - deep / 2, 0}, 0.1, 1, {}, rough);
    World world(scene, {.threads = 1});
    EXPECT_LT(fall_asleep(world), 10) << deep;
  }
}

}  // namespace
}  // namespace plumb::PLUMB_TEST_FILE
