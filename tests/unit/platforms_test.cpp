// Where platforms are within a step, and what of the ground they bring near.

#include "contact/platforms/platforms.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "contact/platforms/anchored.hpp"
#include "contact/platforms/ground_now.hpp"
#include "contact/surroundings.hpp"
#include "support/bodies.hpp"

namespace plumb::detail::PLUMB_TEST_FILE {
namespace {

double distance(const std::array<double, 4>& a, const std::array<double, 4>& b) {
  double sum = 0;
  for (int i = 0; i < 4; ++i) sum += (a[i] - b[i]) * (a[i] - b[i]);
  return std::sqrt(sum);
}

// Rounding of some forty operations.
TEST(Rotation, IsThatOfSineAndCosine) {
  const Vec3 axis{0.36, 0.48, -0.8};
  for (const double angle : {0.0, 1e-9, 0.01, 0.5, 2.0, 3.1, 6.0}) {
    const Vec3 v = std::sin(angle / 2) * axis;
    EXPECT_LE(distance(rotation(angle * axis), {std::cos(angle / 2), v.x, v.y, v.z}), 1e-14) << angle;
  }
}

TEST(TurnBetween, LeadsFromOneToTheOtherTheShorterWay) {
  const std::array<double, 4> from = rotation({1, -0.3, 0.2});
  for (const double angle : {1e-12, 1e-6, 0.039, 0.041, 1.0, 3.0}) {
    const Vec3 turn = angle * Vec3{0.6, 0, 0.8};
    // The product of two turns, as a quaternion.
    const std::array<double, 4> by = rotation(turn);
    const Vec3 u{by[1], by[2], by[3]}, v{from[1], from[2], from[3]};
    const Vec3 w = by[0] * v + from[0] * u + cross(u, v);
    const std::array<double, 4> to{by[0] * from[0] - dot(u, v), w.x, w.y, w.z};
    EXPECT_LE(norm(turn_between(from, to) - turn), 1e-14 * angle + 3e-16) << angle;
    EXPECT_LE(norm(turn_between(from, {-to[0], -to[1], -to[2], -to[3]}) - turn), 1e-14 * angle + 3e-16);
  }
}

Scene scene_with_platform() {
  Scene scene;
  scene.platforms = {{.position = {1, 0, 0}}};
  scene.planes = {{.offset = -0.5, .motion = {.platform = 0}}};
  scene.boxes = {{.center = {2, 0, 0},
                  .half_size = {0.5, 0.1, 0.1},
                  .filter = {.category = 2},
                  .motion = {.platform = 0}}};
  return scene;
}

TEST(Platforms, MoveEvenlyAndEndWhereTheyAreSent) {
  Platforms platforms(scene_with_platform());
  EXPECT_TRUE(platforms.at(0, 0).is_home);
  const Pose target{.position = {3, 0, 1}, .orientation = rotation({0, 1, 0})};
  platforms.set_target(0, target);
  platforms.begin_step(0.5);
  for (const double t : {0.0, 0.2, 0.5}) {
    const PlatformPose at = platforms.at(0, t);
    EXPECT_LE(norm(at.rate.velocity - Vec3{4, 0, 2}) + norm(at.rate.spin - Vec3{0, 2, 0}), 1e-14);
    const Vec3 wanted = Vec3{1 + 4 * t, 0, 2 * t} + Vec3{std::cos(2 * t), 0, -std::sin(2 * t)};
    EXPECT_LE(norm(at.place({2, 0, 0}) - wanted), 1e-14);
    // A material place moves as the rate says.
    const Vec3 later = platforms.at(0, t + 1e-5).place({2, 0, 0}),
               before = platforms.at(0, t - 1e-5).place({2, 0, 0});
    EXPECT_LE(norm(5e4 * (later - before) - at.rate.at(wanted, {0, 1, 0})), 1e-8);
  }
  platforms.end_step();
  const PlatformPose end = platforms.at(0, 0);
  EXPECT_FALSE(end.is_home);
  EXPECT_FALSE(end.moves());
  EXPECT_EQ(end.rate.center, target.position);
}

// A capsule on a body of four anchors moves as they do, and one on two anchors across its line.
TEST(Anchored, MovesAsItsAnchorsDo) {
  Scene scene;
  const std::uint32_t body = test::add_fixed_body(scene);
  const Point end = point_on_body(scene, body, {0, 0, 2});
  scene.particles.push_back(test::movable({9, 9, 9}, 1));
  scene.capsules = {{.a = point_at(4), .b = point_at(4), .radius = 1},
                    {.a = point_at(0), .b = end, .radius = 0.1},
                    {.a = point_at(1), .b = point_at(2), .radius = 0.2}};
  Anchored anchored(scene);
  ASSERT_EQ(anchored.shapes().size(), 2u) << "the first moves by itself";
  EXPECT_FALSE(anchored.any_moves());
  const Vec3 velocity{1, 0, 2}, spin{0.3, 0.2, -0.4};
  for (const std::uint32_t i : anchored.anchors()) {
    const Vec3 x = scene.particles[i].position;
    anchored.set(i, x, velocity + cross(spin, x));
  }
  EXPECT_TRUE(anchored.any_moves());
  for (const Vec3 place : {Vec3{0, 0, 1}, Vec3{0.1, 0.2, 0}}) {
    const Vec3 wanted = velocity + cross(spin, place);
    EXPECT_LE(norm(anchored.rate(0, anchored.positions()).at(place, {0, 1, 0}) - wanted), 1e-14);
  }
  EXPECT_LE(norm(anchored.rate(1, anchored.positions()).spin - spin), 1e-14)
      << "its particles are the body's";
  Array<Vec3> later;
  anchored.find_positions(0.1, later);
  const Segment there = anchored.segment(0, later);
  EXPECT_LE(norm(there.q - (Vec3{0, 0, 2} + 0.1 * (velocity + cross(spin, Vec3{0, 0, 2})))), 1e-14);
  EXPECT_EQ(there.radius, 0.1);
}

// What ground sweeps through within the step counts.
TEST(Surroundings, ReachWhereGroundGoesWithinTheStep) {
  Surroundings ground(scene_with_platform());
  const Filter usual[] = {{}}, other[] = {{.mask = 1}};
  const Bounds above{{1.8, 0.3, -0.1}, {2.2, 0.4, 0.1}};
  ground.begin_step(1);
  EXPECT_FALSE(ground.reach_into(above, usual));
  EXPECT_FALSE(ground.move_under(above, usual));
  ground.platforms.set_target(0, {.position = {1, 0.3, 0}});
  ground.begin_step(1);
  EXPECT_TRUE(ground.reach_into(above, usual)) << "the box rises by 0.3 m";
  EXPECT_TRUE(ground.move_under(above, usual));
  EXPECT_FALSE(ground.reach_into(above, other)) << "which it may not touch";
  EXPECT_NEAR(ground.carried(above, usual).high.y, 0.7, 1e-15);
  ground.end_step();
  ground.begin_step(1);
  EXPECT_TRUE(ground.reach_into({{1.8, 0.35, -0.1}, {2.2, 0.4, 0.1}}, usual)) << "where it is now";
  EXPECT_FALSE(ground.move_under(above, usual));
}

}  // namespace
}  // namespace plumb::detail::PLUMB_TEST_FILE
