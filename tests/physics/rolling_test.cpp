// Balls and cylinders roll, spin and slide as mechanics says: friction acts where they are touched.

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <utility>

#include "support/ground.hpp"

namespace plumb::PLUMB_TEST_FILE {
namespace {

using test::earth;
using test::frame;

constexpr double radius = 0.1, mass = 2;

/// A ball, or a cylinder along z, that lies on the ground. Its body.
std::uint32_t add_round(Scene& scene, bool is_ball, Surface surface) {
  MassProperties solid = solid_sphere(mass, radius);
  if (!is_ball) {
    solid = solid_cylinder(mass, radius, 0.3);
    std::swap(solid.inertia.xx, solid.inertia.zz);  // along z
  }
  solid.center = {0, radius, 0};
  const std::uint32_t body = add_body(scene, solid);
  const Vec3 half{0, 0, is_ball ? 0 : 0.15};
  scene.capsules.push_back({.a = point_on_body(scene, body, solid.center - half),
                            .b = point_on_body(scene, body, solid.center + half),
                            .radius = radius,
                            .surface = surface});
  return body;
}

struct Rolled {
  Vec3 velocity, spin;
  /// How fast its surface slides over the ground, m/s.
  Vec3 slip() const { return velocity + cross(spin, Vec3{0, -radius, 0}); }
};

/// How a ball or a cylinder moves a second after it was at rest.
Rolled roll_down(bool is_ball, double slope, Surface surface, std::uint32_t substeps,
                 double sweep_tolerance = ContactSettings{}.sweep_tolerance) {
  Scene scene = test::sloping_ground(slope, surface);
  const std::uint32_t body = add_round(scene, is_ball, surface);
  Settings settings = test::body_settings(substeps);
  settings.contact.sweep_tolerance = sweep_tolerance;
  World world(scene, settings);
  test::run(world, frame, 60);
  EXPECT_LE(test::deepest(scene, world), 1e-3);
  return {test::velocity_of(world, scene.bodies[body]), test::spin_of(world, scene.bodies[body])};
}

// 1/(1 + I/(m r²)) of g sin: 5/7 and 2/3. The bar is 1e-3.
TEST(RoundThings, RollDownASlopeAtTheirShareOfGravity) {
  for (const bool is_ball : {true, false})
    for (const std::uint32_t substeps : {1u, 4u})
      for (const double slope : {0.1, 0.5}) {
        SCOPED_TRACE(testing::Message()
                     << (is_ball ? "ball" : "cylinder") << ", slope " << slope << ", substeps " << substeps);
        const Rolled end = roll_down(is_ball, slope, {.friction = 0.6}, substeps);
        const double share = is_ball ? 5.0 / 7 : 2.0 / 3;
        const double wanted = share * earth * std::sin(std::atan(slope));
        EXPECT_NEAR(end.velocity.x, wanted, 1e-3 * wanted);
        EXPECT_LE(norm(end.slip()), 1e-3 * wanted);
        EXPECT_LE(std::abs(end.velocity.y) + std::abs(end.velocity.z), 1e-3 * wanted);
      }
}

// They slide where the slope's tangent is more than mu (1 + m r²/I): 7/2 mu and 3 mu. Below, the slip is what
// sweeps leave, which are told to be exact; above, it grows at g (sin - (1 + m r²/I) mu cos).
TEST(RoundThings, SlideWhereTheSlopeIsTooSteep) {
  constexpr double friction = 0.2;
  for (const bool is_ball : {true, false}) {
    SCOPED_TRACE(is_ball ? "ball" : "cylinder");
    const double critical = (is_ball ? 3.5 : 3) * friction;
    const auto slip = [&](double slope) {
      return roll_down(is_ball, slope, {.friction = friction}, 4, 1e-6).slip().x;
    };
    const double slope = 1.001 * critical;
    const double growth = earth * std::cos(std::atan(slope)) * (slope - critical);
    EXPECT_LE(std::abs(slip(0.999 * critical)), 0.1 * growth);
    EXPECT_NEAR(slip(slope), growth, 0.1 * growth);
    const double steep = 1.5 * critical, much = earth * std::cos(std::atan(steep)) * (steep - critical);
    EXPECT_NEAR(slip(steep), much, 1e-3 * much);
  }
}

/// The spin (1/s) of a prism of so many sides after a second down a slope, which starts with a spin. It turns
/// about one corner after the other. Each new one takes a share of the spin, since angular momentum about it
/// is kept: I/(m r²) = 1/2 of the solid adds to the cosine of the angle between corners.
double spin_of_prism(int sides, double slope, double spin) {
  const double half = std::numbers::pi / sides, kept = (0.5 + std::cos(2 * half)) / 1.5,
               tilt = std::atan(slope);
  constexpr double h = 1e-5;
  double angle = -half;
  for (int i = 0; i < 100000; ++i) {
    spin += h * earth * std::sin(angle + tilt) / (1.5 * radius);
    angle += h * spin;
    if (angle < half) continue;
    angle = -half;
    spin *= kept;
  }
  return spin;
}

// A hull rolls over its corners, and every one is a blow. So one of 64 sides is 17 % slower than a cylinder
// after a second, and one of 16 sides 44 %. The polygon is met to 5e-3 with 64 substeps, in which a blow may
// be early or late. All is slower than what makes it leave the ground, spin² r = g.
TEST(RoundThings, OfFlatSidesRollAsPrismsDo) {
  constexpr double slope = 0.1, start = 5;
  for (const int sides : {16, 64}) {
    Scene scene = test::sloping_ground(slope, {.friction = 0.6});
    const double half = std::numbers::pi / sides, height = radius * std::cos(half);
    MassProperties solid = solid_cylinder(mass, radius, 0.3);
    std::swap(solid.inertia.xx, solid.inertia.zz);  // along z
    solid.center = {0, height, 0};
    Hull hull{.body = add_body(scene, solid), .surface = {.friction = 0.6}};
    for (int i = 0; i < sides; ++i)
      for (const double z : {-0.15, 0.15}) {
        const double angle = (2 * i + 1) * half;
        hull.points.push_back(solid.center + Vec3{radius * std::sin(angle), -radius * std::cos(angle), z});
      }
    scene.hulls.push_back(hull);
    const double spin = start * radius / height;
    test::set_motion(scene, hull.body, {spin * height, 0, 0}, {0, 0, -spin});
    World world(scene, test::body_settings(64));
    test::run(world, frame, 60);
    const double wanted = spin_of_prism(sides, slope, spin);
    EXPECT_NEAR(-test::spin_of(world, scene.bodies[hull.body]).z, wanted, 5e-3 * wanted) << sides;
    const double of_cylinder = start + 2.0 / 3 * earth * std::sin(std::atan(slope)) / radius;
    EXPECT_LE(wanted, (sides == 64 ? 0.84 : 0.57) * of_cylinder);
  }
}

double kinetic_of(const Scene& scene, const World& world) {
  return measure_energy(scene, test::positions_of(world), test::velocities_of(world), MassModel::consistent)
      .kinetic;
}

// Angular momentum about the line of touch is kept: 5/7 of the speed is left, after 2 v/(7 mu g).
TEST(BilliardBall, RollsAtFiveSeventhsOnceItHasSlid) {
  for (const std::uint32_t substeps : {1u, 4u}) {
    constexpr double friction = 0.3, speed = 2;
    Scene scene = test::sloping_ground(0, {.friction = friction});
    const std::uint32_t body = add_round(scene, true, {.friction = friction});
    test::set_motion(scene, body, {speed, 0, 0}, {});
    World world(scene, test::body_settings(substeps));
    double energy = kinetic_of(scene, world);
    const double slides = 2 * speed / (7 * friction * earth);
    for (int i = 0; i < 60; ++i) {
      world.step(frame);
      const double now = kinetic_of(scene, world);
      EXPECT_LE(now, energy * (1 + 1e-12));
      energy = now;
      if (world.time() < slides - frame) {
        EXPECT_NEAR(test::velocity_of(world, scene.bodies[body]).x, speed - friction * earth * world.time(),
                    1e-3 * speed);
      }
    }
    const Rolled end{test::velocity_of(world, scene.bodies[body]), test::spin_of(world, scene.bodies[body])};
    EXPECT_NEAR(end.velocity.x, 5.0 / 7 * speed, 1e-3 * speed);
    EXPECT_LE(norm(end.slip()), 1e-3 * speed);
  }
}

// A ball that rolls over a resisting surface slows down by 5/7 g rho/r, and rests on slopes below rho/r.
TEST(BilliardBall, IsSlowedByWhatResistsRolling) {
  constexpr double length = 2e-3, speed = 1;
  Scene scene = test::sloping_ground(0, {.friction = 0.5, .rolling = length});
  const std::uint32_t body = add_round(scene, true, {.friction = 0.5});
  test::set_motion(scene, body, {speed, 0, 0}, {0, 0, -speed / radius});
  World world(scene, test::body_settings(4));
  test::run(world, frame, 60);
  const double lost = 5.0 / 7 * earth * length / radius;
  EXPECT_NEAR(test::velocity_of(world, scene.bodies[body]).x, speed - lost, 1e-3);
  const Surface resisting{.friction = 0.5, .rolling = length};
  EXPECT_LE(norm(roll_down(true, 0.99 * length / radius, resisting, 4).velocity), 1e-4);
  const double slope = 1.5 * length / radius;
  const double wanted = 5.0 / 7 * earth * std::cos(std::atan(slope)) * (slope - length / radius);
  EXPECT_NEAR(roll_down(true, slope, resisting, 4).velocity.x, wanted, 0.01 * wanted);
}

// A ball that spins about the normal does so for ever, or is slowed by sigma m g / I until it stands.
TEST(BilliardBall, IsSlowedByWhatResistsSpinning) {
  for (const double length : {0.0, 1e-3}) {
    constexpr double spin = 4;
    Scene scene = test::sloping_ground(0, {.friction = 0.5, .spinning = length});
    const std::uint32_t body = add_round(scene, true, {.friction = 0.5});
    test::set_motion(scene, body, {}, {0, spin, 0});
    World world(scene, test::body_settings(4));
    test::run(world, frame, 30);
    const double slows = length * earth / (0.4 * radius * radius);
    EXPECT_NEAR(test::spin_of(world, scene.bodies[body]).y, spin - 0.5 * slows, 1e-3 * spin);
    test::run(world, frame, 90);
    EXPECT_NEAR(test::spin_of(world, scene.bodies[body]).y, length == 0 ? spin : 0, 1e-3 * spin);
    EXPECT_LE(norm(test::velocity_of(world, scene.bodies[body])), 1e-6);
  }
}

// Two spinning balls that rub on each other push at one place, so that they keep momentum and angular
// momentum, as exactly as the energy that is held against it: lengths are kept to 1e-8, and so is that.
TEST(SpinningBalls, KeepTheMomentaOfTheWhole) {
  Scene scene;
  scene.gravity = {};
  const Surface rough{.friction = 0.4, .restitution = 0.3};
  for (const double side : {-1.0, 1.0}) {
    const std::uint32_t body = add_round(scene, true, rough);
    for (const std::uint32_t i : scene.bodies[body].particles)
      scene.particles[i].position += {0.15 * side, 0.02 * side, 0};
    scene.bodies[body].center += {0.15 * side, 0.02 * side, 0};
    test::set_motion(scene, body, {-side, 0.1 * side, 0.2}, {3, 5 * side, 20});
  }
  World world(scene, test::body_settings(4));
  const Momentum before = test::momentum_of(scene, world);
  const Vec3 spin = test::spin_of(world, scene.bodies[0]);
  test::run(world, frame, 30);
  const Momentum after = test::momentum_of(scene, world);
  EXPECT_GT(norm(test::spin_of(world, scene.bodies[0]) - spin), 1) << "they rub";
  EXPECT_LE(norm(after.linear - before.linear), 1e-8 * mass);
  EXPECT_LE(norm(after.angular - before.angular), 1e-6 * norm(before.angular));
}

// A rod lies on ground along x and slides along itself. Friction acts a radius below its axis, so that the
// end ahead carries mu m g r/L more than half of its weight. With a radius of L/(2 mu), it carries all of it.
TEST(SlidingRod, LeansOnTheEndAhead) {
  constexpr double friction = 0.5, length = 1;
  for (const double share : {0.8, 1.2}) {
    const double thick = share * length / (2 * friction);
    Scene scene = test::sloping_ground(0, {.friction = friction});
    const Surface surface{.friction = friction};
    test::add_capsule_rod(scene, {0, thick, 0}, {length, thick, 0}, mass, thick, surface);
    for (Particle& particle : scene.particles) particle.velocity = {2, 0, 0};
    World world(scene, test::body_settings(4));
    test::run(world, frame, 6);
    if (share < 1) {
      EXPECT_NEAR(world.velocity(1).x, 2 - friction * earth * 0.1, 1e-3);
      EXPECT_LE(std::abs(world.position(0).y - thick), 1e-4);
    } else {
      EXPECT_GE(world.position(0).y - thick, 1e-3) << "the end behind lifts off";
    }
  }
}

}  // namespace
}  // namespace plumb::PLUMB_TEST_FILE
