// Poses and motions of bodies, against what a body that flies freely does and against turns that are set.

#include <gtest/gtest.h>

#include <cmath>
#include <random>
#include <string>
#include <vector>

#include "plumb/plumb.hpp"
#include "scene/poses/body_poses.hpp"
#include "support/bodies.hpp"
#include "support/refusals.hpp"

namespace plumb::PLUMB_TEST_FILE {
namespace {

Vec3 turned(const std::array<double, 4>& q, Vec3 v) {
  const Vec3 u{q[1], q[2], q[3]}, t = 2 * cross(u, v);
  return v + q[0] * t + cross(u, t);
}

/// Boxes that fly and tumble, without gravity.
Scene flying(std::uint32_t bodies, std::uint32_t seed) {
  std::mt19937 random(seed);
  std::uniform_real_distribution<double> number(-1, 1);
  const auto vector = [&] { return Vec3{number(random), number(random), number(random)}; };
  Scene scene;
  scene.gravity = {};
  for (std::uint32_t i = 0; i < bodies; ++i) {
    MassProperties box = solid_box(0.5 + i, Vec3{0.1, 0.2, 0.3});
    box.center = Vec3{3.0 * i, 0, 0} + vector();
    test::set_motion(scene, add_body(scene, box), vector(), 5 * vector());
  }
  return scene;
}

TEST(Poses, AreThoseOfTheSceneAtFirst) {
  Scene scene = flying(1, 3);
  test::set_motion(scene, 0, {1, 2, 3}, {4, 5, 6});
  const World world(scene, test::body_settings());
  EXPECT_EQ(world.body_count(), 1u);
  EXPECT_LT(norm(world.pose(0).position - scene.bodies[0].center), 1e-14);
  EXPECT_NEAR(world.pose(0).orientation[0], 1, 1e-14);
  EXPECT_LT(norm(world.motion(0).velocity - Vec3{1, 2, 3}), 1e-12);
  EXPECT_LT(norm(world.motion(0).spin - Vec3{4, 5, 6}), 1e-12);
}

// Poses take all places of a body to where they are, and motions say how these move, to what a substep leaves
// of the lengths of a body's rods: 1e-8 m, and 5 1/s times that.
TEST(Poses, TakePlacesOfABodyToWhereTheyAre) {
  const Scene scene = flying(5, 1);
  World world(scene, test::body_settings());
  double most_turned = 1;
  for (int step = 0; step < 200; ++step) {
    world.step(1.0 / 120);
    for (std::uint32_t i = 0; i < scene.bodies.size(); ++i) {
      const Body& body = scene.bodies[i];
      const Pose pose = world.pose(i);
      const BodyMotion motion = world.motion(i);
      most_turned = std::min(most_turned, pose.orientation[0]);
      for (const std::uint32_t particle : body.particles) {
        const Vec3 arm = turned(pose.orientation, scene.particles[particle].position - body.center);
        ASSERT_LT(norm(pose.position + arm - world.position(particle)), 1e-8) << step;
        ASSERT_LT(norm(motion.velocity + cross(motion.spin, arm) - world.velocity(particle)), 5e-8) << step;
      }
    }
  }
  EXPECT_LT(most_turned, 0.1) << "no body has turned far, so that this test does not say much";
}

// Newton's iteration for what mirrors would end at a reflection, which no quaternion is.
TEST(Poses, OfAMirrorImageAreRotations) {
  const Scene scene = flying(5, 4);
  const detail::BodyPoses poses(scene);
  for (std::uint32_t i = 0; i < scene.bodies.size(); ++i) {
    std::array<Vec3, 4> at;
    for (std::size_t k = 0; k < 4; ++k) {
      at[k] = scene.particles[scene.bodies[i].particles[k]].position;
      at[k].y = -at[k].y;
    }
    const auto [w, x, y, z] = poses.pose(i, at).orientation;
    EXPECT_NEAR(w * w + x * x + y * y + z * z, 1, 1e-14);
    const BodyMotion motion = poses.motion(i, at, {});
    EXPECT_EQ(motion.spin, Vec3{});
  }
}

// A ball turns as fast as it did: after a time t by spin t, in quaternions cos(|spin| t / 2).
TEST(Poses, OfABallThatSpinsTurnEvenly) {
  Scene scene;
  add_body(scene, solid_sphere(2, 0.1));
  test::set_motion(scene, 0, {0.5, 0, 0}, {0, 0, 2});
  World world(scene, test::body_settings());
  for (int i = 0; i < 500; ++i) world.step(1e-3);
  const Pose pose = world.pose(0);
  // A substep turns by 2 atan(spin h / 2), which is spin^3 h^2 / 12 less in a second.
  EXPECT_NEAR(pose.orientation[0], std::cos(0.5), 5e-7);
  EXPECT_NEAR(pose.orientation[3], std::sin(0.5), 5e-7);
  EXPECT_NEAR(pose.position.x, 0.25, 1e-12);
  EXPECT_NEAR(pose.position.y, scene.gravity.y / 8, 1e-10);
}

// A body that sweeps have sheared by e has the turn between its sheared edges, to e^2: half of e.
TEST(Poses, OfStrainedBodiesAreTheNearestRotation) {
  Scene scene;
  add_body(scene, solid_sphere(1, 0.1));
  const detail::BodyPoses poses(scene);
  std::array<Vec3, 4> at{};
  for (std::size_t i = 0; i < 4; ++i) {
    at[i] = scene.particles[scene.bodies[0].particles[i]].position;
    at[i].x += 1e-3 * at[i].y;
  }
  const Pose pose = poses.pose(0, at);
  EXPECT_NEAR(2 * pose.orientation[3], -5e-4, 1e-9);
  EXPECT_NEAR(pose.orientation[1], 0, 1e-15);
  EXPECT_NEAR(pose.orientation[2], 0, 1e-15);
}

TEST(Poses, OfAllAreThoseOfEach) {
  const Scene scene = flying(4, 2);
  World world(scene, test::body_settings());
  std::vector<Pose> poses(4);
  std::vector<BodyMotion> motions(4);
  for (int step = 0; step < 10; ++step) {
    world.step(1.0 / 60);
    world.copy_poses(poses);
    world.copy_motions(motions);
    for (std::uint32_t i = 0; i < 4; ++i) {
      EXPECT_EQ(poses[i], world.pose(i));
      EXPECT_EQ(motions[i], world.motion(i));
    }
  }
  EXPECT_EQ(test::refusal([&] { world.pose(4); }), "body 4: unknown, the world has 4 bodies");
  EXPECT_EQ(test::refusal([&] { world.copy_poses(std::span(poses).first(3)); }),
            "poses of 4 bodies cannot be copied into 3 elements");
  EXPECT_EQ(test::refusal([&] { world.copy_motions(std::span(motions).first(3)); }),
            "motions of 4 bodies cannot be copied into 3 elements");
}

}  // namespace
}  // namespace plumb::PLUMB_TEST_FILE
