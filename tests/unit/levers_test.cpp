// How surfaces of shapes move with their islands.

#include <gtest/gtest.h>

#include "contact/levers/lever.hpp"
#include "contact/levers/shape_maker.hpp"
#include "contact/platforms/ground_rate.hpp"
#include "support/bodies.hpp"
#include "support/linkages.hpp"

namespace plumb::detail::PLUMB_TEST_FILE {
namespace {

constexpr Vec3 place{0.3, -0.2, 0.5}, velocity{1, 2, -1};

double rate_of(const Lever::Rate& rate, std::span<const Vec3> v) {
  return dot(rate.along_a, rate.a.of(v)) + dot(rate.along_b, rate.b.of(v));
}

/// Compares what a lever says of an island that moves as a rigid whole with what its motion is.
void expect_rigid(const Scene& scene, Vec3 spin) {
  const test::Linkages islands(scene);
  const LinkageState& state = islands.states.front();
  std::vector<Vec3> v;
  for (const Vec3 x : state.x) v.push_back(velocity + cross(spin, x - place));
  const Linkage::Shape& shape = state.linkage->shapes().front();
  const Vec3 arm{0.02, -0.05, 0.03}, at = shape.a.of(state.x);
  const Lever lever(shape, shape.a, arm, state.x);
  ASSERT_TRUE(lever.turns());
  for (const Vec3 t : {Vec3{1, 0, 0}, Vec3{0, 1, 0}, Vec3{0, 0, 1}, Vec3{0.6, 0, 0.8}}) {
    EXPECT_NEAR(rate_of(lever.sliding(t), v), dot(t, velocity + cross(spin, at + arm - place)), 1e-12);
    EXPECT_NEAR(rate_of(lever.turning(t), v), dot(t, spin), 1e-12);
  }
}

TEST(Lever, FollowsABodyHoweverItTurns) {
  Scene scene;
  const std::uint32_t body = add_body(scene, solid_box(2, {0.3, 0.4, 0.5}));
  const Point at = point_on_body(scene, body, {0.1, 0.05, -0.1});
  scene.capsules.push_back({.a = at, .b = at, .radius = 0.1});
  expect_rigid(scene, {3, -2, 1});
}

TEST(Lever, FollowsARodHoweverItTurnsAcrossItself) {
  Scene scene;
  const Vec3 along{0.6, 0.8, 0};
  test::add_capsule_rod(scene, place, place + 1.5 * along, 1, 0.1);
  expect_rigid(scene, cross(along, Vec3{1, 2, 3}));
  const Point middle = point_on_rod(scene, 0, 0.3);
  scene.capsules[0].a = scene.capsules[0].b = middle;
  expect_rigid(scene, cross(along, Vec3{1, 2, 3}));
}

TEST(Lever, OfABallOnOneParticleDoesNotTurn) {
  Scene scene;
  test::add_ball(scene, place, 0.1, 1);
  const test::Linkages islands(scene);
  const LinkageState& state = islands.states.front();
  const Linkage::Shape& shape = state.linkage->shapes().front();
  const Lever lever(shape, shape.a, {0, -0.1, 0}, state.x);
  EXPECT_FALSE(lever.turns());
  EXPECT_EQ(rate_of(lever.sliding({0, 1, 0}), std::array{velocity}), 2);
}

// A shape turns with a body, or with a rod that stays one; cables may be slack, and what breaks is no rod.
TEST(ShapeMaker, FindsWhatAShapeTurnsWith) {
  using Turning = Linkage::Shape::Turning;
  Scene scene;
  const std::uint32_t body = add_body(scene, solid_box(2, {0.3, 0.4, 0.5}));
  test::add_capsule_rod(scene, {1, 0, 0}, {2, 0, 0}, 1, 0.1);
  scene.particles.push_back(test::movable({3, 0, 0}, 1));
  const auto last = static_cast<std::uint32_t>(scene.particles.size() - 1), rod = last - 2;
  scene.rods.push_back({.a = last - 1, .b = last});
  const auto turning = [&](const Point& a, const Point& b) {
    TermPool places;
    return ShapeMaker(scene).make({.a = a, .b = b, .radius = 0.1}, places).turning;
  };
  const Point inside = point_on_body(scene, body, {0.1, 0, 0});
  EXPECT_EQ(turning(inside, inside), Turning::body);
  EXPECT_EQ(turning(inside, point_at(scene.bodies[body].particles[2])), Turning::body);
  EXPECT_EQ(turning(inside, point_at(rod)), Turning::none);
  EXPECT_EQ(turning(point_at(rod), point_at(rod)), Turning::none);
  EXPECT_EQ(turning(point_at(rod + 1), point_at(rod)), Turning::line);
  EXPECT_EQ(turning(point_at(rod), point_at(last)), Turning::none) << "no rod joins them";
  EXPECT_EQ(turning(point_at(rod + 1), point_at(last)), Turning::line);
  scene.rods.back().law.strength = 1e3;
  EXPECT_EQ(turning(point_at(rod + 1), point_at(last)), Turning::none);
  scene.rods.back().law = {.one_sided = true};
  EXPECT_EQ(turning(point_at(rod + 1), point_at(last)), Turning::none);
  for (const std::uint32_t i : {rod, last}) scene.particles[i].fixed = true;
  EXPECT_EQ(turning(point_at(rod), point_at(last)), Turning::line) << "two anchors";
}

// Belts move along the surface alone.
TEST(GroundRate, IsThatOfARigidBodyAndOfABelt) {
  const GroundRate rate{.center = {1, 0, 0}, .velocity = {0, 0, 1}, .spin = {0, 2, 0}, .belt = {1, 5, 0}};
  EXPECT_EQ(rate.at({2, 0, 0}, {0, 1, 0}), (Vec3{1, 0, -1}));
  EXPECT_EQ(rate.later(0.5).at({2, 0, 0.5}, {0, 1, 0}), (Vec3{1, 0, -1}));
  // What sticks to a turntable goes round; what lies on a drum is not let in.
  const GroundRate turns{.spin = {0, 2, 0}};
  const Vec3 round = turns.moved({1, 0, 0}, {0, 1, 0}, 0.25);
  EXPECT_LE(norm(round - Vec3{std::cos(0.5) - 1, 0, -std::sin(0.5)}), 1e-15);
  EXPECT_EQ(turns.moved({1, 0, 0}, {1, 0, 0}, 0.25).x, 0);
}

}  // namespace
}  // namespace plumb::detail::PLUMB_TEST_FILE
