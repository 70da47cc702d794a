// A rod that falls on a table, aslant and without friction, or slides on it where friction has no answer that
// is finite.

#include <gtest/gtest.h>

#include <cmath>

#include "support/bodies.hpp"

namespace plumb::PLUMB_TEST_FILE {
namespace {

constexpr double length = 1, mass = 2;

/// A uniform rod that falls evenly, an end first, `lean` (rad) from level.
Scene falling_rod(double lean, double speed, double thick, bool is_body) {
  Scene scene;
  scene.gravity = {};
  scene.planes.push_back({.surface = test::smooth});
  const Vec3 low{0, thick + 0.01, 0}, along = length * Vec3{std::cos(lean), std::sin(lean), 0};
  if (!is_body) {
    test::add_capsule_rod(scene, low, low + along, mass, thick);
  } else {
    const double across = mass * length * length / 12, own = 1e-4 * across, c = std::cos(lean),
                 s = std::sin(lean);
    const std::uint32_t body = add_body(scene, {.mass = mass,
                                                .center = low + 0.5 * along,
                                                .inertia = {.xx = own * c * c + across * s * s,
                                                            .yy = own * s * s + across * c * c,
                                                            .zz = across,
                                                            .xy = (own - across) * c * s}});
    scene.capsules.push_back({.a = point_on_body(scene, body, low),
                              .b = point_on_body(scene, body, low + along),
                              .radius = thick,
                              .surface = test::smooth});
  }
  for (Particle& particle : scene.particles) particle.velocity = {0, -speed, 0};
  return scene;
}

Vec3 velocity_of(const World& world, const Point& point) {
  Vec3 sum{};
  for (std::size_t k = 0; k < 4; ++k)
    if (point.weights[k] != 0) sum += point.weights[k] * world.velocity(point.particles[k]);
  return sum;
}

// The end that lands stops, by an impulse m V/4: the middle goes on at 3/4 V, and the other end hits the
// table at 3/2 V. That is so but for the square of the lean, 1e-4, and for what a sweep may leave of the
// first blow; the bar is 1e-3.
TEST(TiltedRod, HitsWithItsOtherEndAtThreeHalves) {
  for (const bool is_body : {false, true})
    for (const std::uint32_t substeps : {1u, 4u})
      for (const double speed : {1.0, 5.0}) {
        SCOPED_TRACE(testing::Message() << (is_body ? "body" : "rod") << ", " << substeps << ", " << speed);
        const Scene scene = falling_rod(0.01, speed, 0.01, is_body);
        const Capsule& capsule = scene.capsules[0];
        World world(scene, test::body_settings(substeps));
        double last = -speed;
        while (world.time() < 0.1 && velocity_of(world, capsule.b).y < -0.1 * speed) {
          last = velocity_of(world, capsule.b).y;
          world.step(1.0 / 240 / speed);
        }
        EXPECT_NEAR(last, -1.5 * speed, 1e-3 * 1.5 * speed);
        test::run(world, 1.0 / 240, 20);
        EXPECT_GE(test::place_of(world, capsule.a).y, 0.01 - 1e-3);
        EXPECT_GE(test::place_of(world, capsule.b).y, 0.01 - 1e-3);
      }
}

/// Painleve's rod: its tip slides on the ground and is pushed from behind, its other end `lean` (rad) above
/// level. A push of one at the tip lifts it by 1 + 3 cos (cos - mu sin) of what it would lift a point.
Scene painleve_rod(double lean, double friction, double speed) {
  Scene scene;
  const Surface surface{.friction = friction};
  scene.planes.push_back({.surface = surface});
  test::add_capsule_rod(scene, {}, length * Vec3{std::cos(lean), std::sin(lean), 0}, mass, 0, surface);
  for (Particle& particle : scene.particles) particle.velocity = {-speed, 0, 0};
  return scene;
}

// Where that is negative no force is finite (Painleve 1895). The answer is an impulse without a collision
// (Lecornu; Stewart 2000): the tip sticks at once, since sliding on only presses it down. What is left is
// what the rod turns with about its tip: the energy of its angular momentum m V L/2 sin about there.
TEST(PainleveRod, SticksAtOnceWhereNoForceIsFinite) {
  for (const auto& [lean, friction] : {std::pair{1.0, 2.0}, std::pair{1.2, 3.0}, std::pair{0.8, 3.0}}) {
    ASSERT_LT(1 + 3 * std::cos(lean) * (std::cos(lean) - friction * std::sin(lean)), 0);
    for (const double dt : {1.0 / 60, 1e-3})
      for (const double speed : {0.5, 1.0}) {
        SCOPED_TRACE(testing::Message() << lean << ", dt " << dt << ", " << speed);
        const Scene scene = painleve_rod(lean, friction, speed);
        World world(scene, test::body_settings());
        const auto energy = [&] {
          return measure_energy(scene, test::positions_of(world), test::velocities_of(world),
                                MassModel::consistent)
              .total();
        };
        const double moving = 0.5 * mass * speed * speed, start = energy();
        const double turning = 0.75 * moving * std::sin(lean) * std::sin(lean);  // (m V L/2 sin)²/(2 m L²/3)
        double last = start;
        for (int i = 0; i < 12; ++i) {
          const StepReport report = world.step(dt);
          EXPECT_EQ(report.unsolved, 0u);
          EXPECT_LE(report.newton + report.halvings, 40u) << "no search without end";
          EXPECT_LE(energy(), last + 1e-9 * start);
          last = energy();
          if (i > 0) continue;
          EXPECT_LE(norm(world.velocity(0)), 1e-3 * speed);
          EXPECT_LE(norm(world.position(0)), 1e-3 * speed * dt + 1e-6);
          EXPECT_NEAR(last, start - moving + turning, 2e-3 * moving);
        }
      }
  }
}

}  // namespace
}  // namespace plumb::PLUMB_TEST_FILE
