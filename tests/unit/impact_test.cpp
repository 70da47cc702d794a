#include "plumb/reference/impact.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <limits>
#include <string>
#include <vector>

#include "plumb/error.hpp"
#include "support/random_trees.hpp"

namespace plumb::PLUMB_TEST_FILE {
namespace {

constexpr double infinity = std::numeric_limits<double>::infinity();
constexpr double nan = std::numeric_limits<double>::quiet_NaN();

Vec3 times(const Inertia& i, Vec3 v) {
  return {i.xx * v.x + i.xy * v.y + i.xz * v.z, i.xy * v.x + i.yy * v.y + i.yz * v.z,
          i.xz * v.x + i.yz * v.y + i.zz * v.z};
}

Vec3 linear_momentum(const RigidMotion& body) {
  return body.mass * body.velocity;
}
/// About the origin.
Vec3 angular_momentum(const RigidMotion& body) {
  return cross(body.center, linear_momentum(body)) + times(body.inertia, body.angular_velocity);
}
double energy(const RigidMotion& body) {
  return 0.5 * body.mass * dot(body.velocity, body.velocity) +
         0.5 * dot(body.angular_velocity, times(body.inertia, body.angular_velocity));
}

Vec3 random_unit(test::Random& random) {
  const Vec3 v = test::random_vector(random) + Vec3{0.01, 0, 0};
  return (1 / norm(v)) * v;
}

/// With the inertia of six random points about their centre.
RigidMotion random_body(test::Random& random) {
  std::vector<PointMass> points;
  for (int i = 0; i < 6; ++i)
    points.push_back({test::random_vector(random), 0.6 + 0.5 * test::signed_unit(random)});
  const MassProperties weight = mass_properties(points);
  return {.mass = weight.mass,
          .inertia = weight.inertia,
          .center = weight.center,
          .velocity = test::random_vector(random),
          .angular_velocity = test::random_vector(random)};
}

struct Hit {
  RigidMotion a, b;
  Vec3 contact, normal;
  double restitution;

  double apart() const { return dot(velocity_at(a, contact) - velocity_at(b, contact), normal); }
};

/// Two bodies that near each other at the contact.
Hit random_hit(test::Random& random) {
  Hit hit{.a = random_body(random),
          .b = random_body(random),
          .contact = test::random_vector(random),
          .normal = random_unit(random),
          .restitution = (1 + test::signed_unit(random)) / 2};
  if (hit.apart() > 0) hit.normal = -1 * hit.normal;
  return hit;
}

// A ball that hits an equal one at rest stops, and the other goes on: worked out by hand.
TEST(Impact, OfEqualBallsExchangesVelocities) {
  RigidMotion a{.mass = 2, .velocity = {3, 1, 0}}, b{.mass = 2, .velocity = {0, 0, 0}};
  EXPECT_DOUBLE_EQ(impulse(a, b, {-1, 0, 0}, 1), 6);
  collide(a, b, {-1, 0, 0}, 1);
  EXPECT_EQ(a.velocity, (Vec3{0, 1, 0}));
  EXPECT_EQ(b.velocity, (Vec3{3, 0, 0}));
}

// What eq. 2.33 as printed gets wrong: bodies side by side at one speed do not collide.
TEST(Impact, NeedsBodiesThatNearEachOther) {
  RigidMotion a{.mass = 1, .velocity = {5, 0, 0}}, b{.mass = 3, .velocity = {5, 0, 0}};
  EXPECT_EQ(impulse(a, b, {1, 0, 0}, 0.5), 0);
  b.velocity.x = 4;
  EXPECT_EQ(impulse(a, b, {1, 0, 0}, 0.5), 0) << "they part";
  b.velocity.x = 6;
  EXPECT_GT(impulse(a, b, {1, 0, 0}, 0.5), 0);
}

// Eq. 2.31 and 2.32 to rounding of numbers of order one.
TEST(Impact, WithoutSpinKeepsMomentumAndRestitution) {
  test::Random random(11);
  for (int round = 0; round < 1000; ++round) {
    Hit hit = random_hit(random);
    hit.a.angular_velocity = hit.b.angular_velocity = {};
    if (hit.apart() > 0) hit.normal = -1 * hit.normal;
    const Hit before = hit;
    collide(hit.a, hit.b, hit.normal, hit.restitution);
    EXPECT_LE(norm(linear_momentum(hit.a) + linear_momentum(hit.b) - linear_momentum(before.a) -
                   linear_momentum(before.b)),
              1e-12);
    EXPECT_NEAR(hit.apart(), -hit.restitution * before.apart(), 1e-12);
    EXPECT_LE(energy(hit.a) + energy(hit.b), energy(before.a) + energy(before.b) + 1e-12);
  }
}

// The same at the contact of bodies that spin, with angular momentum about the origin; all energy is kept by
// a restitution of 1. Tolerances: rounding, times what the inverse of a thin body's inertia makes of it.
TEST(Impact, WithSpinKeepsMomentumAndRestitution) {
  test::Random random(12);
  for (int round = 0; round < 1000; ++round) {
    Hit hit = random_hit(random);
    if (round % 4 == 0) hit.restitution = 1;
    const Hit before = hit;
    const double j = impulse(hit.a, hit.b, hit.contact, hit.normal, hit.restitution);
    EXPECT_GE(j, 0);
    collide(hit.a, hit.b, hit.contact, hit.normal, hit.restitution);
    EXPECT_LE(norm(linear_momentum(hit.a) - linear_momentum(before.a) - j * hit.normal), 1e-12);
    EXPECT_LE(norm(linear_momentum(hit.a) + linear_momentum(hit.b) - linear_momentum(before.a) -
                   linear_momentum(before.b)),
              1e-12);
    EXPECT_LE(norm(angular_momentum(hit.a) + angular_momentum(hit.b) - angular_momentum(before.a) -
                   angular_momentum(before.b)),
              1e-12);
    EXPECT_NEAR(hit.apart(), -hit.restitution * before.apart(), 1e-12);
    const double lost = energy(before.a) + energy(before.b) - energy(hit.a) - energy(hit.b);
    EXPECT_GE(lost, -1e-12);
    if (hit.restitution == 1) {
      EXPECT_NEAR(lost, 0, 1e-12);
    }
  }
}

// Through both centres of mass nothing turns, and the two formulas are one.
TEST(Impact, ThroughTheCentersDoesNotTurn) {
  test::Random random(13);
  for (int round = 0; round < 100; ++round) {
    Hit hit = random_hit(random);
    hit.a.angular_velocity = hit.b.angular_velocity = {};
    hit.a.center = hit.contact + 0.5 * hit.normal;
    hit.b.center = hit.contact - 0.7 * hit.normal;
    EXPECT_NEAR(impulse(hit.a, hit.b, hit.contact, hit.normal, hit.restitution),
                impulse(hit.a, hit.b, hit.normal, hit.restitution), 1e-12);
    collide(hit.a, hit.b, hit.contact, hit.normal, hit.restitution);
    EXPECT_LE(norm(hit.a.angular_velocity) + norm(hit.b.angular_velocity), 1e-12);
  }
}

// The bat of thesis 2.5: a rod hit at its end takes up a quarter of the impulse that one hit in the middle
// would need for the same speed there; it moves off with J/m and spins with J L/2 / (m L^2/12) = 6 J/(m L).
TEST(Impact, AtTheEndOfABatMakesItSpin) {
  RigidMotion bat{.mass = 3, .inertia = solid_cylinder(3, 1e-3, 2).inertia};
  RigidMotion ball{.mass = infinity, .velocity = {0, 1, 0}};
  const double j = impulse(bat, ball, {1, 0, 0}, {0, 1, 0}, 0);
  EXPECT_NEAR(j, 3.0 / 4, 1e-6);
  collide(bat, ball, {1, 0, 0}, {0, 1, 0}, 0);
  EXPECT_NEAR(bat.velocity.y, j / 3, 1e-12);
  EXPECT_NEAR(bat.angular_velocity.z, 6 * j / (3 * 2), 1e-6);
}

TEST(Impact, DoesNotMoveInfiniteMass) {
  RigidMotion ball{.mass = 2, .inertia = solid_sphere(2, 0.1).inertia, .velocity = {1, -3, 0}};
  RigidMotion wall{.mass = infinity, .center = {7, -5, 0}, .velocity = {0, 1, 0}};
  collide(ball, wall, {0, -0.1, 0}, {0, 1, 0}, 0.5);
  EXPECT_EQ(wall.velocity, (Vec3{0, 1, 0}));
  EXPECT_EQ(wall.angular_velocity, Vec3{});
  EXPECT_DOUBLE_EQ(ball.velocity.y, 1 + 0.5 * 4);
  EXPECT_DOUBLE_EQ(ball.velocity.x, 1);
}

TEST(Impact, RefusesNonsense) {
  const auto refusal = [](const std::function<void(Hit&)>& change) -> std::string {
    const RigidMotion body{.mass = 1, .inertia = {.xx = 1, .yy = 1, .zz = 1}};
    Hit hit{.a = body, .b = body, .contact = {}, .normal = {1, 0, 0}, .restitution = 0};
    change(hit);
    try {
      collide(hit.a, hit.b, hit.contact, hit.normal, hit.restitution);
    } catch (const InputError& error) {
      return error.what();
    }
    return {};
  };
  EXPECT_EQ(refusal([](Hit&) {}), "");
  EXPECT_EQ(refusal([](Hit& h) { h.b.mass = 0; }), "body b: mass must be positive, got 0 kg");
  EXPECT_EQ(refusal([](Hit& h) { h.a.center.x = nan; }), "body a: center of mass is not finite");
  EXPECT_EQ(refusal([](Hit& h) { h.a.velocity.x = nan; }), "body a: velocity is not finite");
  EXPECT_EQ(refusal([](Hit& h) { h.b.angular_velocity.x = infinity; }),
            "body b: angular velocity is not finite");
  EXPECT_EQ(refusal([](Hit& h) { h.a.inertia.xy = nan; }), "body a: inertia is not finite");
  EXPECT_EQ(refusal([](Hit& h) { h.a.inertia.xy = 1; }), "body a: inertia is not positive definite");
  EXPECT_EQ(refusal([](Hit& h) { h.a.mass = h.b.mass = infinity; }),
            "bodies a and b: both masses are infinite");
  EXPECT_EQ(refusal([](Hit& h) { h.normal.x = 2; }), "normal must be of length 1, not 2");
  EXPECT_EQ(refusal([](Hit& h) { h.restitution = 1.5; }), "restitution must be from 0 to 1, got 1.5");
  EXPECT_EQ(refusal([](Hit& h) { h.contact.y = nan; }), "contact is not finite");
}

}  // namespace
}  // namespace plumb::PLUMB_TEST_FILE
