// Ground that moves where the user says carries what lies on it: lifts, belts and turntables.

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "support/ground.hpp"

namespace plumb::PLUMB_TEST_FILE {
namespace {

using test::earth;
using test::frame;

/// What lies still is as exact as sweeps are told to be.
Settings exact_settings(std::uint32_t substeps = 1) {
  Settings out = test::body_settings(substeps);
  out.contact.sweep_tolerance = 1e-11;
  out.contact.length_scale = 1e-3;
  out.tensions = true;
  return out;
}

// It goes where the lift goes, and weighs m (g + a), with a the change of the lift's velocity over a step.
TEST(Lift, CarriesABlockThatWeighsMoreTheFasterItRises) {
  for (const bool is_plane : {true, false}) test::ride_lift(is_plane, exact_settings(), 1e-9, 1e-6);
}

// What a lift does is work, not a gain of energy by contact that is held back.
TEST(Lift, ThrowsABallAsHighAsItsSpeedSays) {
  Scene scene;
  scene.platforms.emplace_back();
  scene.planes.push_back({.motion = {.platform = 0}});
  test::add_ball(scene, {0, 0.1, 0}, 0.1, 1);
  World world(scene, test::body_settings(4));
  constexpr double speed = 3;
  StepReport report;
  for (int i = 1; i <= 10; ++i) {
    world.move_platform(0, {.position = {0, i * frame * speed, 0}});
    report += world.step(frame);
  }
  EXPECT_NEAR(world.velocity(0).y, speed, 1e-9);
  EXPECT_EQ(report.guarded_energy + report.trimmed_energy, 0u);
  double top = 0;
  for (int i = 0; i < 40; ++i) {
    world.step(frame);
    top = std::max(top, world.position(0).y);
  }
  EXPECT_NEAR(top, 0.1 + 10 * frame * speed + speed * speed / (2 * earth), 1e-3);
}

// A restitution of 1 against a wall that comes at u: a ball at rest leaves at 2 u.
TEST(MovingWall, StrikesABallAtRest) {
  EXPECT_NEAR(test::speed_from_wall(test::body_settings(2)), 4, 1e-6);
}

// Friction mu g brings what lies on a belt to its speed, and no further. A ball on it starts to roll, and
// keeps 2/7 of that speed.
TEST(Belt, BringsWhatLiesOnItToItsSpeed) {
  for (const bool is_box : {false, true}) {
    Scene scene;
    const Surface surface{.friction = 0.3};
    const GroundMotion belt{.belt = {2, 0, 0}};
    if (is_box)
      scene.boxes.push_back(
          {.center = {0, -1, 0}, .half_size = {9, 1, 9}, .surface = surface, .motion = belt});
    else
      scene.planes.push_back({.surface = surface, .motion = belt});
    test::add_capsule_rod(scene, {0, 0.05, -0.5}, {0, 0.05, 0.5}, 1, 0.05, surface);
    MassProperties ball = solid_sphere(1, 0.1);
    ball.center = {0, 0.1, 2};
    const std::uint32_t body = add_body(scene, ball);
    const Point middle = point_on_body(scene, body, ball.center);
    scene.capsules.push_back({.a = middle, .b = middle, .radius = 0.1, .surface = surface});
    World world(scene, test::body_settings(4));
    for (int i = 0; i < 60; ++i) {
      world.step(frame);
      const double wanted = std::min(2.0, 0.3 * earth * world.time());
      EXPECT_NEAR(world.velocity(0).x, wanted, 1e-3) << "frame " << i;
      EXPECT_NEAR(world.velocity(1).x, wanted, 1e-3) << "frame " << i;
    }
    EXPECT_NEAR(test::velocity_of(world, scene.bodies[body]).x, 2.0 * 2 / 7, 2e-3);
    EXPECT_NEAR(test::spin_of(world, scene.bodies[body]).z, 2.0 * 5 / 7 / 0.1, 2e-2);
  }
}

// It sticks where rate² radius is below mu g, 5 % either way; its corners are up to 0.25 m apart, but slide
// as a whole. What sweeps leave of sliding adds up as on a slope.
TEST(Turntable, CarriesABlockUnlessItTurnsTooFast) {
  constexpr double friction = 0.5;
  const double critical = std::sqrt(friction * earth / 0.5);
  EXPECT_LE(test::slid_on_turntable(0.95 * critical, friction, test::body_settings(4), 180), 2e-3);
  EXPECT_GE(test::slid_on_turntable(1.1 * critical, friction, test::body_settings(4), 180), 0.1);
}

// A table that is tilted about its middle: the block lies still until the slope's tangent is mu.
TEST(TiltedTable, LetsABlockSlideBeyondItsAngleOfFriction) {
  constexpr double friction = 0.4;
  Scene scene;
  const Surface surface{.friction = friction};
  scene.platforms.emplace_back();
  scene.boxes.push_back(
      {.center = {0, -0.1, 0}, .half_size = {2, 0.1, 1}, .surface = surface, .motion = {.platform = 0}});
  const std::uint32_t body = test::add_block(scene, {0.5, 0, 0}, surface);
  World world(scene, test::body_settings(4));
  const double critical = std::atan(friction);
  double began = 0;
  for (int i = 1; began == 0 && i <= 600; ++i) {
    const double angle = 0.1 * i * frame;
    world.move_platform(0, {.orientation = test::turned(-angle, {0, 0, 1})});
    world.step(frame);
    const Vec3 along{std::cos(angle), -std::sin(angle), 0}, up{std::sin(angle), std::cos(angle), 0};
    const Vec3 at = test::center_of(world, scene.bodies[body]);
    EXPECT_NEAR(dot(at, up), 0.1, 1e-3);
    if (dot(at, along) > 0.505) began = angle;
  }
  // Once it slides, it takes 5 mm at a rate that grows by 0.1 g cos t: 0.31 s, or 0.031 rad.
  EXPECT_NEAR(began, critical + 0.031, 0.01);
}

/// A rope of 24 rods over half of a drum along z, with one end tied to the ground on the left and the other
/// pulled down on the right. The drum is a body on four anchors, the first particles of the scene.
Scene rope_over_drum(double friction) {
  constexpr double radius = 0.2, thick = 0.01;
  Scene scene;
  scene.gravity = {};
  const Surface surface{.friction = friction};
  for (const Vec3 at : {Vec3{0.3, 0, 0.1}, Vec3{-0.3, 0, 0.1}, Vec3{0, 0.3, -0.1}, Vec3{0, -0.3, -0.1}})
    scene.particles.push_back(test::fixed(at));
  const std::uint32_t drum = add_body(scene, {0, 1, 2, 3}, solid_sphere(1, 0.1));
  scene.capsules.push_back({.a = point_on_body(scene, drum, {0, 0, -0.5}),
                            .b = point_on_body(scene, drum, {0, 0, 0.5}),
                            .radius = radius,
                            .surface = surface});
  constexpr int around = 20, hanging = 2;
  const double turn = std::numbers::pi / around, far = (radius + thick) / std::cos(turn / 2);
  const double link = 2 * far * std::sin(turn / 2);
  for (int i = -hanging; i <= around + hanging; ++i) {
    const double angle = turn * std::clamp(i, 0, around);
    const double down = link * std::max({0, -i, i - around});
    const Vec3 at{-far * std::cos(angle), far * std::sin(angle) - down, 0};
    scene.particles.push_back(i == -hanging ? test::fixed(at) : test::movable(at, 0.02));
    const auto here = static_cast<std::uint32_t>(scene.particles.size() - 1);
    if (i == -hanging) continue;
    scene.rods.push_back({.a = here - 1, .b = here});
    scene.capsules.push_back(
        {.a = point_at(here - 1), .b = point_at(here), .radius = thick, .surface = surface});
  }
  return scene;
}

// Euler and Eytelwein: where a drum turns under a rope, the pulls differ by exp(friction pi), towards where
// its surface goes. It takes the rope's end on the left along that is tied there, or eases it.
TEST(Drum, PullsARopeByTheCapstansRatio) {
  constexpr double friction = 0.3, pull = 10;
  const Scene scene = rope_over_drum(friction);
  Settings settings = test::body_settings(4);
  settings.tensions = true;
  for (const double way : {1.0, -1.0}) {
    World world(scene, settings);
    world.set_force(world.particle_count() - 1, {0, -pull, 0});
    double sum = 0;
    constexpr int frames = 60, last = 20;
    for (int i = 1; i <= frames; ++i) {
      const double angle = -way * i * frame;  // its top goes to the right if `way` is 1
      for (std::uint32_t k = 0; k < 4; ++k) {
        const Vec3 x = scene.particles[k].position;
        world.move_anchor(k, {std::cos(angle) * x.x - std::sin(angle) * x.y,
                              std::sin(angle) * x.x + std::cos(angle) * x.y, x.z});
      }
      world.step(frame);
      if (i > frames - last) sum += -world.reaction(4).y;
    }
    const double wanted = pull * std::exp(way * friction * std::numbers::pi);
    EXPECT_NEAR(sum / last, wanted, 0.02 * wanted) << way;
  }
}

// A bar on two anchors, as a lift has it: what lies across goes with it.
TEST(CapsuleOnAnchors, CarriesWhatLiesOnIt) {
  Scene scene;
  scene.particles = {test::fixed({0, 0, -1}), test::fixed({0, 0, 1})};
  scene.capsules = {{.a = point_at(0), .b = point_at(1), .radius = 0.1}};
  const std::uint32_t rod = test::add_capsule_rod(scene, {-0.5, 0.15, 0}, {0.5, 0.15, 0}, 2, 0.05, {});
  ASSERT_EQ(rod, 0u);
  Settings settings = exact_settings();
  World world(scene, settings);
  for (int i = 1; i <= 60; ++i) {
    const double height = 0.5 * 2 * (i * frame) * (i * frame);
    world.move_anchor(0, {0, height, -1});
    world.move_anchor(1, {0, height, 1});
    world.step(frame);
    EXPECT_NEAR(0.5 * (world.position(2).y + world.position(3).y), 0.15 + height, 1e-9) << i;
    if (i > 1) {
      EXPECT_NEAR(world.contact_force(1).y, 2 * (earth + 2), 1e-6) << i;
    }
  }
  EXPECT_NEAR(world.contact_force(0).y, -2 * (earth + 2), 1e-6) << "the opposite, on ground";
}

TEST(Sleepers, WakeWhenTheirGroundMovesAndStayAwakeOnBelts) {
  Scene scene;
  scene.platforms.emplace_back();
  scene.planes.push_back({.motion = {.platform = 0}});
  test::add_ball(scene, {0, 0.1, 0}, 0.1, 1, {}, {});
  World world(scene, test::body_settings(1, true));
  test::run(world, frame, 60);
  ASSERT_EQ(world.step(frame).awake_islands, 0u);
  for (int i = 1; i <= 60; ++i) {
    // Slower than what counts as rest.
    world.move_platform(0, {.position = {0, 1e-4 * i, 0}});
    EXPECT_EQ(world.step(frame).awake_islands, 1u);
  }
  EXPECT_NEAR(world.position(0).y, 0.1 + 6e-3, 1e-6);
  test::run(world, frame, 60);
  EXPECT_EQ(world.step(frame).awake_islands, 0u) << "the lift stands";

  scene.planes[0].motion = {.belt = {0.01, 0, 0}};
  World on_belt(scene, test::body_settings(1, true));
  test::run(on_belt, frame, 120);
  EXPECT_NEAR(on_belt.velocity(0).x, 0.01, 1e-6);
  EXPECT_NEAR(on_belt.position(0).x, 0.02, 1e-3);
}

// Ropes go home to their own solver where nothing is near, and sleep there.
TEST(Sleepers, OfTheirOwnSolversWakeWhenGroundComes) {
  Scene scene;
  scene.gravity = {};
  scene.platforms.emplace_back();
  scene.boxes.push_back({.center = {0, -2, 0}, .half_size = {1, 0.5, 1}, .motion = {.platform = 0}});
  test::add_capsule_rod(scene, {-0.5, 0, 0}, {0.5, 0, 0}, 1, 0.05);
  World world(scene, test::body_settings(1, true));
  test::run(world, frame, 90);
  ASSERT_EQ(world.step(frame).awake_islands, 0u);
  for (int i = 1; i <= 120; ++i) {
    world.move_platform(0, {.position = {0, i * frame, 0}});
    world.step(frame);
  }
  EXPECT_GE(world.position(0).y, 0.5) << "the box is 0.5 m up";
}

// A racket at v hits a ball of speed u, which leaves at u + 2 v: more than either has, alone or together.
TEST(MovingGround, RacketsGiveABallTwiceTheirSpeedMore) {
  for (const Method method : {Method::direct, Method::relax})
    for (const double ball : {0.5, 2.0, 8.0}) {
      constexpr double racket = 2;  // m/s
      Scene scene;
      scene.gravity = {};
      const Surface surface{.friction = 0, .restitution = 1};
      scene.platforms.emplace_back();
      scene.boxes.push_back(
          {.center = {0, -0.5, 0}, .half_size = {1, 0.5, 1}, .surface = surface, .motion = {.platform = 0}});
      test::add_ball(scene, {0, 0.3, 0}, 0.1, 1, {0, -ball, 0}, surface);
      World world(scene, {.method = method, .substeps = 4, .threads = 1});
      for (int i = 1; i <= 12; ++i) {
        world.move_platform(0, {.position = {0, i * frame * racket, 0}});
        world.step(frame);
      }
      SCOPED_TRACE(testing::Message() << to_string(method) << ", ball " << ball);
      EXPECT_NEAR(world.velocity(0).y, ball + 2 * racket, 1e-6);
    }
}

/// Blocks on a turntable that tilts, in a lift.
Scene crowd_on_platforms() {
  Scene scene;
  const Surface surface{.friction = 0.4, .restitution = 0.2};
  scene.platforms.resize(2);
  scene.planes.push_back({.surface = surface, .motion = {.platform = 0, .belt = {0.2, 0, 0}}});
  scene.boxes.push_back(
      {.center = {0, 0.2, 0}, .half_size = {1, 0.2, 1}, .surface = surface, .motion = {.platform = 1}});
  for (int i = 0; i < 12; ++i)
    test::add_block(scene, {0.6 * (i % 4) - 0.9, 0.5 + 0.3 * (i / 4), 0.1 * (i % 3)}, surface);
  return scene;
}

std::uint64_t hash_of_crowd(Isa isa, unsigned threads) {
  Settings settings = test::body_settings(2, true);
  settings.isa = isa;
  settings.threads = threads;
  World world(crowd_on_platforms(), settings);
  for (int i = 1; i <= 60; ++i) {
    world.move_platform(0, {.position = {0, 0.3 * i * frame, 0}});
    world.move_platform(
        1, {.position = {0, 0.3 * i * frame, 0}, .orientation = test::turned(i * frame, {0, 0.8, 0.6})});
    world.step(frame);
  }
  return world.state_hash();
}

TEST(MovingGround, GivesTheSameBitsOnEveryMachine) {
  const std::uint64_t wanted = hash_of_crowd(Isa::scalar, 1);
  EXPECT_EQ(hash_of_crowd(Isa::scalar, 2), wanted);
  for (const Isa isa : {Isa::sse2, Isa::avx2, Isa::avx512})
    if (is_supported(isa)) {
      EXPECT_EQ(hash_of_crowd(isa, 2), wanted) << to_string(isa);
    }
}

// An accuracy takes steps back and repeats them, finer: the ground goes back with them.
TEST(MovingGround, IsWhereItShouldBeWhenStepsAreRepeated) {
  Scene scene;
  scene.platforms.emplace_back();
  scene.planes.push_back({.surface = {.restitution = 0.5}, .motion = {.platform = 0}});
  const std::uint32_t body = test::add_block(scene, {0, 0.3, 0}, {});
  Settings settings = test::body_settings(1);
  settings.accuracy = 1e-3;
  World world(scene, settings);
  std::uint64_t repeated = 0;
  for (int i = 1; i <= 120; ++i) {
    world.move_platform(0, {.position = {0, 0.5 * i * frame, 0}});
    repeated += world.step(frame).repeated_steps;
  }
  EXPECT_GT(repeated, 0u);
  EXPECT_NEAR(test::center_of(world, scene.bodies[body]).y, 0.1 + 1, 1e-3);
}

// A lift comes down on a rope until less is left than the rope is thick. What gives way moves about as fast
// as the lift. Before, ropes were thrown at 10¹⁶ m/s, or had velocities that are no numbers for a step.
TEST(Lift, CrushesWhatItComesDownOn) {
  constexpr double radius = 0.05, thickness = 0.1;
  for (const std::uint32_t rods : {10u, 20u, 40u})
    for (const double left : {0.0, 0.02}) {
      Scene scene;
      scene.planes.emplace_back();
      scene.platforms.emplace_back();
      scene.boxes.push_back({.center = {0, 0.5, 0}, .half_size = {2, 0.1, 1}, .motion = {.platform = 0}});
      for (std::uint32_t i = 0; i <= rods; ++i) {
        scene.particles.push_back(test::movable({-0.9 + 1.8 * i / rods, radius, 0.5}, 0.1));
        if (i == 0) continue;
        scene.rods.push_back({.a = i - 1, .b = i});
        scene.capsules.push_back({.a = point_at(i - 1), .b = point_at(i), .radius = radius});
      }
      World world(scene, {.threads = 1});
      double fastest = 0;
      bool is_sound = true;
      for (int i = 1; i <= 120; ++i) {
        world.move_platform(0, {.position = {0, std::max(left - 4 * thickness, -0.5 * i * frame), 0}});
        world.step(frame);
        for (std::uint32_t k = 0; k <= rods; ++k) {
          is_sound = is_sound && is_finite(world.velocity(k)) && is_finite(world.position(k));
          fastest = std::max(fastest, norm(world.velocity(k)));
        }
      }
      EXPECT_TRUE(is_sound) << rods << ' ' << left;
      EXPECT_LE(fastest, 5) << rods << ' ' << left;
    }
}

}  // namespace
}  // namespace plumb::PLUMB_TEST_FILE
