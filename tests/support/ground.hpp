#pragma once

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>

#include "support/bodies.hpp"

/// What tests of slopes and of ground that moves share.
namespace plumb::test {

/// Ground that slopes down towards x by `slope` (its tangent): gravity leans instead.
inline Scene sloping_ground(double slope, Surface surface) {
  Scene scene;
  const double angle = std::atan(slope);
  scene.gravity = earth * Vec3{std::sin(angle), -std::cos(angle), 0};
  scene.planes.push_back({.surface = surface});
  return scene;
}

constexpr double block_mass = 2;  ///< kg

/// A block on the corners of its bottom, whose centre is above `at`. Its body.
inline std::uint32_t add_block(Scene& scene, Vec3 at, Surface surface) {
  const Vec3 size{0.4, 0.2, 0.3};
  MassProperties block = solid_box(block_mass, size);
  block.center = at + Vec3{0, size.y / 2, 0};
  const std::uint32_t body = add_body(scene, block);
  for (const double x : {-0.2, 0.2})
    for (const double z : {-0.15, 0.15}) {
      const Point corner = point_on_body(scene, body, at + Vec3{x, 0, z});
      scene.capsules.push_back({.a = corner, .b = corner, .radius = 0, .surface = surface});
    }
  return body;
}

inline Vec3 center_of(const World& world, const Body& body) {
  Vec3 sum{};
  for (const std::uint32_t i : body.particles) sum += world.position(i);
  return 0.25 * sum;
}

inline std::array<double, 4> turned(double angle, Vec3 axis) {
  const Vec3 v = std::sin(angle / 2) * axis;
  return {std::cos(angle / 2), v.x, v.y, v.z};
}

/// A lift carries a block: up with 2 m/s², on evenly, and to the side slowly enough for friction. The block
/// goes where the lift goes, to `off` (m), and weighs m (g + a), to `off_weight` (N), with a the change of
/// the lift's velocity over a step.
inline void ride_lift(bool is_plane, const Settings& settings, double off, double off_weight) {
  Scene scene;
  scene.platforms = {{.position = {3, -1, 2}}};
  if (is_plane)
    scene.planes.push_back({.motion = {.platform = 0}});
  else
    scene.boxes.push_back({.center = {0, -0.5, 0}, .half_size = {1, 0.5, 1}, .motion = {.platform = 0}});
  const std::uint32_t body = add_block(scene, {}, {});
  const Vec3 start = scene.bodies[body].center;
  World world(scene, settings);
  double speed = 0;
  Vec3 way{};
  for (int i = 0; i < 90; ++i) {
    const double before = speed;
    if (i < 30) speed += 2 * frame;
    way += frame * Vec3{i < 60 ? 0 : 0.01 * (i - 60), speed, 0};
    world.move_platform(0, {.position = scene.platforms[0].position + way});
    world.step(frame);
    EXPECT_LE(norm(center_of(world, scene.bodies[body]) - start - way), off) << "frame " << i;
    double weight = 0;
    for (std::uint32_t k = 0; k < 4; ++k) weight += world.contact_force(k).y;
    EXPECT_NEAR(weight, block_mass * (earth + (speed - before) / frame), off_weight) << "frame " << i;
  }
  EXPECT_EQ(world.platform(0).position, scene.platforms[0].position + way);
}

/// How fast a ball leaves, m/s, that was at rest until a wall with a restitution of 1 came at 2 m/s.
inline double speed_from_wall(const Settings& settings) {
  Scene scene;
  scene.gravity = {};
  scene.platforms.emplace_back();
  const Surface elastic{.friction = 0, .restitution = 1};
  scene.boxes.push_back(
      {.center = {-1, 0, 0}, .half_size = {0.1, 1, 1}, .surface = elastic, .motion = {.platform = 0}});
  add_ball(scene, {0, 0, 0}, 0.1, 1, {}, elastic);
  World world(scene, settings);
  for (int i = 1; i <= 60; ++i) {
    world.move_platform(0, {.position = {2 * i * frame, 0, 0}});
    world.step(frame);
  }
  return world.velocity(0).x;
}

/// A block 0.5 m from the axis of a turntable that gently comes to its rate (1/s) in two seconds, and some
/// `frames` from the start. How far it is from where it would be if it stuck, m.
inline double slid_on_turntable(double rate, double friction, const Settings& settings, int frames) {
  Scene scene;
  const Surface surface{.friction = friction};
  scene.platforms = {{.position = {1, 0, 0}}};
  scene.planes.push_back({.surface = surface, .motion = {.platform = 0}});
  const std::uint32_t body = add_block(scene, {1.5, 0, 0}, surface);
  World world(scene, settings);
  double angle = 0;
  for (int i = 1; i <= frames; ++i) {
    angle += frame * rate * std::min(1.0, i / 120.0);
    world.move_platform(0, {.position = {1, 0, 0}, .orientation = turned(angle, {0, 1, 0})});
    world.step(frame);
  }
  const Vec3 stuck = Vec3{1, 0.1, 0} + 0.5 * Vec3{std::cos(angle), 0, -std::sin(angle)};
  return norm(center_of(world, scene.bodies[body]) - stuck);
}

}  // namespace plumb::test
