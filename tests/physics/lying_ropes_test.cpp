// Ropes that touch the ground in many places: friction, rest, and a cost that does not grow with their
// number.

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "plumb/measures.hpp"
#include "support/bodies.hpp"

namespace plumb::PLUMB_TEST_FILE {
namespace {

using test::frame;

constexpr double link = 0.05, radius = 0.01;

/// A rope of `links` capsules along x, its axis a radius above the ground and `height` (m) more, with
/// ripples of a millimetre if it is not straight.
Scene rope(int links, double height, double friction, bool straight) {
  Scene scene;
  for (int i = 0; i <= links; ++i) {
    const double ripple = straight ? 0 : 0.001 * std::sin(0.7 * i);
    scene.particles.push_back({.position = {link * i, radius + height + ripple, 0}, .mass = 0.05});
  }
  for (std::uint32_t i = 0; i < static_cast<std::uint32_t>(links); ++i) {
    scene.rods.push_back({.a = i, .b = i + 1});
    scene.capsules.push_back({.a = point_at(i),
                              .b = point_at(i + 1),
                              .radius = radius,
                              .surface = {.friction = friction, .restitution = 0}});
  }
  scene.planes.push_back({.surface = {.friction = friction, .restitution = 0}});
  return scene;
}

/// Turns the weight instead of the ground.
void incline(Scene& scene, double angle) {
  scene.gravity = test::earth * Vec3{std::sin(angle), -std::cos(angle), 0};
}

// Friction takes mu g of the speed in every second. What it takes in a substep is exact but for what its grip
// leaves, a hundredth of that in the first substep alone.
TEST(LyingRope, SlidesToAHalt) {
  Scene scene = rope(40, 0, 0.3, true);
  for (Particle& particle : scene.particles) particle.velocity = {0, 0, 2};
  World world(scene, test::body_settings(4));
  const double g = 0.3 * test::earth;
  for (int i = 0; i < 30; ++i) {
    const StepReport report = world.step(frame);
    ASSERT_EQ(report.unsolved, 0u);
  }
  for (const std::uint32_t i : {0u, 17u, 40u}) {
    EXPECT_NEAR(world.velocity(i).z, 2 - g * world.time(), 1e-3);
    EXPECT_NEAR(world.position(i).z, 2 * world.time() - 0.5 * g * world.time() * world.time(), 2e-3);
  }
  while (world.time() < 2) world.step(frame);
  EXPECT_NEAR(world.position(20).z, 2 * 2 / (2 * g), 5e-3);
  EXPECT_LT(norm(world.velocity(20)), 1e-6);
}

// A slope a thousandth below the angle of friction holds a rope, and one a thousandth above does not.
TEST(LyingRope, SlidesBeyondItsAngleOfFriction) {
  const double friction = 0.4, critical = std::atan(friction);
  for (const double share : {0.999, 1.001}) {
    Scene scene = rope(40, 0, friction, true);
    incline(scene, share * critical);
    Settings settings = test::body_settings(1);
    settings.sleep = false;
    World world(scene, settings);
    for (int i = 0; i < 240; ++i) ASSERT_EQ(world.step(frame).unsolved, 0u);
    const double pull = test::earth * (std::sin(share * critical) - friction * std::cos(share * critical));
    const double slid = world.position(20).x - link * 20;
    SCOPED_TRACE(testing::Message() << "share " << share << ": " << slid << " m");
    if (share < 1)
      EXPECT_LT(std::abs(slid), 1e-4);
    else
      EXPECT_NEAR(slid, 0.5 * pull * 16, 0.02 * 0.5 * pull * 16 + 1e-4);
  }
}

// What holds rods and keeps shapes apart stays exact while a rope falls flat, and Newton steps do not grow in
// number with its length.
TEST(LyingRope, FallsFlatAtACostThatIsLinear) {
  for (const double friction : {0.0, 0.5}) {
    std::uint64_t newton[2]{};
    int at = 0;
    for (const int links : {40, 160}) {
      SCOPED_TRACE(testing::Message() << links << " links, friction " << friction);
      const Scene scene = rope(links, 0.1, friction, false);
      World world(scene, test::body_settings(1));
      std::vector<Vec3> x(scene.particles.size());
      for (int i = 0; i < 60; ++i) {
        const StepReport report = world.step(frame);
        ASSERT_EQ(report.unsolved, 0u);
        newton[at] += report.newton;
        world.copy_positions(x);
        ASSERT_LT(measure_stretch(scene, x).max, 1e-6);
        for (const Vec3 p : x) ASSERT_GT(p.y, radius - 1e-3);
      }
      for (std::uint32_t i = 0; i < x.size(); ++i) EXPECT_LT(norm(world.velocity(i)), 0.02);
      ++at;
    }
    EXPECT_LT(newton[1], 4 * newton[0] + 100);
  }
}

}  // namespace
}  // namespace plumb::PLUMB_TEST_FILE
