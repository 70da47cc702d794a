// Scenes with bodies, joints and contact: what cannot move them is refused with the reason, extremes stay
// finite, and what breaks is one island's alone.

#include "support/bodies.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <limits>
#include <string>
#include <vector>

#include "scenes/humanoid/humanoid.hpp"
#include "scenes/spec.hpp"
#include "support/refusals.hpp"

namespace plumb::PLUMB_TEST_FILE {
namespace {

using test::frame;
using test::refusal;

// The reason names what was asked for.
TEST(Bodies, WithShapesAreRefusedToMethodsThatKnowRodsOrJointsAlone) {
  const Scene scene = scenes::load_scene("humanoid:body=thin");
  for (const Method method : {Method::springs, Method::multipliers, Method::featherstone}) {
    const std::string reason = refusal([&] { World(scene, {.method = method, .threads = 1}); });
    EXPECT_NE(reason.find(to_string(method)), std::string::npos) << reason;
    const bool moves_joints = method == Method::multipliers || method == Method::featherstone;
    EXPECT_NE(reason.find(moves_joints ? "shapes" : "joints"), std::string::npos) << reason;
  }
  EXPECT_EQ(refusal([&] { World(scene, {.method = Method::relax, .threads = 1}); }), "");
  for (const Method method : {Method::automatic, Method::direct}) {
    EXPECT_EQ(refusal([&] { World(scene, {.method = method, .threads = 1}); }), "");
    EXPECT_EQ(refusal([&] { World(scene, {.method = method, .accuracy = 1e-3, .threads = 1}); }), "");
    for (const Gradient gradient : {Gradient::new_, Gradient::old, Gradient::mid})
      EXPECT_EQ(refusal([&] { World(scene, {.method = method, .gradient = gradient, .threads = 1}); }), "");
  }
}

// A joint that nothing moves. A shape that nothing moves is ground.
TEST(Bodies, OnFixedParticlesAloneAreRefused) {
  Scene scene;
  scene.particles = {test::fixed({0, 0, 0}), test::fixed({1, 0, 0}), test::movable({0, 1, 0})};
  scene.capsules.push_back({.a = point_at(0), .b = point_at(1), .radius = 0.1});
  EXPECT_EQ(refusal([&] { World(scene, test::body_settings()); }), "");
  scene.pins.push_back({point_at(0), point_at(1)});
  EXPECT_NE(refusal([&] { World(scene, test::body_settings()); }).find("fixed"), std::string::npos);
}

TEST(Bodies, RefuseStepsAndChangesThatMakeNoSense) {
  World world(scenes::load_scene("humanoid:body=thin"), test::body_settings());
  const double nan = std::numeric_limits<double>::quiet_NaN();
  for (const double dt : {0.0, -1.0, nan})
    EXPECT_NE(refusal([&] { world.step(dt); }).find("dt"), std::string::npos);
  EXPECT_NE(refusal([&] { world.set_force(0, {nan, 0, 0}); }).find("particle 0"), std::string::npos);
  EXPECT_NE(refusal([&] { world.set_force(99, {}); }).find("99"), std::string::npos);
  EXPECT_NE(refusal([&] { world.move_anchor(0, {}); }).find("movable"), std::string::npos);
}

/// A figure whose limbs weigh from 1 to `ratio` times one of them, and a ball of 1 kg that hits it.
Scene lopsided(double unit, double ratio) {
  Scene scene = scenes::make_humanoid({.body = scenes::BodyType::thin});
  for (std::size_t i = 0; i < scene.rods.size(); ++i) {
    const double mass = unit * std::pow(ratio, static_cast<double>(i % 3) / 2);
    *scene.rods[i].inertia *= mass / scene.rods[i].mass;
    scene.rods[i].mass = mass;
  }
  scenes::throw_ball(scene, {.speed = 20, .mass = 1}, scenes::torso_center({.body = scenes::BodyType::thin}));
  return scene;
}

// 1 g to 100 t, in one figure and against the ball. 1 % is the bar for strain.
TEST(Bodies, StayFiniteAtExtremeMasses) {
  for (const double unit : {1e-3, 1.0, 1e5})
    for (const double ratio : {1.0, 1e4, 1e-4}) {
      SCOPED_TRACE(testing::Message() << unit << " kg, ratio " << ratio);
      const Scene scene = lopsided(unit, ratio);
      World world(scene, test::body_settings(1, true));
      double strain = 0;
      StepReport report;
      for (int i = 0; i < 120; ++i) {
        report += world.step(frame);
        ASSERT_TRUE(test::all_finite(world)) << "step " << i;
        strain = std::max(strain, test::stretch_of(scene, world).max);
      }
      EXPECT_LE(strain, 0.01);
      EXPECT_EQ(report.frozen_islands, 0u);
    }
}

TEST(Bodies, StayFiniteAtExtremeSteps) {
  for (const char* spec : {"humanoid:body=wide", "stick_box", "drop", "crowd:humanoids=4,hit=4,body=thin"})
    for (const double dt : {1e-5, 1e-3, 0.1, 0.5, 1.0}) {
      SCOPED_TRACE(testing::Message() << spec << ", dt " << dt);
      Scene scene = scenes::load_scene(spec);
      for (Particle& particle : scene.particles) particle.asleep = false;
      World world(scene, test::body_settings(1, true));
      for (int i = 0; i < 50; ++i) {
        world.step(dt);
        ASSERT_TRUE(test::all_finite(world)) << "step " << i;
      }
      EXPECT_LE(test::stretch_of(scene, world).max, 0.01);
    }
}

/// Three figures, awake, in a scene with a ball for one of them, far enough from another ball to be alone.
Scene figures_and_a_loose_ball() {
  Scene scene = scenes::load_scene("crowd:humanoids=3,hit=1,body=thin");
  for (Particle& particle : scene.particles) particle.asleep = false;
  test::add_ball(scene, {-50, 3, 0}, 0.1, 1);
  return scene;
}

void expect_alike(const World& world, const World& twin, std::uint32_t first, std::uint32_t last) {
  for (std::uint32_t i = first; i < last; ++i) {
    EXPECT_EQ(world.position(i), twin.position(i)) << i;
    EXPECT_EQ(world.velocity(i), twin.velocity(i)) << i;
  }
}

// A force that no step is short enough for: the figure stays where it is, and that is reported. The others go
// on, to the bit.
TEST(Bodies, LeaveTheOthersAloneWhenOneCannotBeSolved) {
  const Scene scene = figures_and_a_loose_ball();
  World world(scene, test::body_settings()), twin(scene, test::body_settings());
  test::run(world, frame, 2);
  test::run(twin, frame, 2);
  const std::vector<Vec3> before = test::positions_of(world);
  world.set_force(13, {1e308, 1e308, 0});
  EXPECT_EQ(test::run(world, frame, 10).unsolved, 10u);
  test::run(twin, frame, 10);
  for (std::uint32_t i = 10; i < 20; ++i) {
    EXPECT_EQ(world.position(i), before[i]) << i;
    EXPECT_EQ(world.velocity(i), Vec3{}) << i;
  }
  expect_alike(world, twin, 0, 10);
  expect_alike(world, twin, 20, 32);
}

// Nor does what it leaves in memory reach those that are moved after it.
TEST(Bodies, MoveAfterAnIslandThatBroke) {
  Scene scene;
  const std::uint32_t breaks = test::add_ball(scene, {0, 0, 0}, 0.1, 1e-8);
  const std::uint32_t falls = test::add_ball(scene, {50, 0, 0}, 0.1, 1);
  scene.joint_drag = 1;  // which does nothing to a ball, but only the contact solver knows it
  World world(scene, test::body_settings());
  world.set_force(breaks, {0, 1.7e308, 0});
  std::uint32_t frozen = 0;
  for (int i = 0; i < 10; ++i) frozen += world.step(frame).frozen_islands;
  EXPECT_EQ(frozen, 1u);
  EXPECT_NEAR(world.position(falls).y, -0.5 * test::earth * world.time() * world.time(), 1e-12);
}

// A ball whose numbers run out is put back to where it was, stands still from then on, and is counted once.
TEST(Bodies, FreezeOnlyTheIslandThatBroke) {
  const Scene scene = figures_and_a_loose_ball();
  const std::uint32_t ball = 31;
  for (const double mass : {1.0, 1e-8}) {
    Scene light = scene;
    light.particles[ball].mass = mass;
    World world(light, test::body_settings()), twin(light, test::body_settings());
    world.set_force(ball, {0, 1.7e308, 0});
    std::uint32_t frozen = 0;
    for (int i = 0; i < 8; ++i) {
      frozen += world.step(0.5).frozen_islands;
      twin.step(0.5);
      ASSERT_TRUE(test::all_finite(world)) << "step " << i;
    }
    EXPECT_EQ(frozen, 1u) << mass;
    EXPECT_EQ(world.velocity(ball), Vec3{});
    EXPECT_TRUE(test::all_finite(twin));
  }
}

}  // namespace
}  // namespace plumb::PLUMB_TEST_FILE
