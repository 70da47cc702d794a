// Newton's cradle: what one ball brings leaves with one ball.

#include <gtest/gtest.h>

#include <cmath>
#include <vector>

#include "support/bodies.hpp"

namespace plumb::PLUMB_TEST_FILE {
namespace {

constexpr int balls = 5;
constexpr double radius = 0.05, speed = 1;

/// Five elastic balls in line, `gap` (m) apart, of which the first `count` come along.
Scene cradle(double gap, int count) {
  Scene scene;
  scene.gravity = {};
  for (int i = 0; i < balls; ++i)
    test::add_ball(scene, {i * (2 * radius + gap) - (i < count ? 0.05 : 0), 0, 0}, radius, 1,
                   {i < count ? speed : 0, 0, 0}, {.friction = 0, .restitution = 1});
  return scene;
}

std::vector<double> speeds_after(const Scene& scene, double dt) {
  World world(scene, test::body_settings());
  while (world.time() < 0.5) EXPECT_EQ(world.step(dt).unsolved, 0u);
  std::vector<double> out;
  for (std::uint32_t i = 0; i < balls; ++i) out.push_back(world.velocity(i).x);
  return out;
}

// With gaps that a substep resolves, blows follow each other, and each exchanges two velocities: but for the
// 1e-6 m/s that sweeps may leave, the last balls leave alone.
TEST(Cradle, LetsAsManyLeaveAsComeIfItHasGaps) {
  for (const auto& [gap, dt] : {std::pair{1e-2, 1.0 / 120}, std::pair{1e-3, 1.0 / 2000}})
    for (const int count : {1, 2}) {
      const std::vector<double> out = speeds_after(cradle(gap, count), dt);
      for (int i = 0; i < balls; ++i)
        EXPECT_NEAR(out[static_cast<std::size_t>(i)], i < balls - count ? 0 : speed, 1e-5)
            << gap << ", " << count << ", ball " << i;
    }
}

// Without gaps, or where a substep does not resolve them, all contacts push at once. Only the one that is hit
// has a restitution, and the balls behind it go on as one: (1 - 4)/5 and 2/5 of the speed. Momentum and
// energy are kept.
TEST(Cradle, GoesOnAsOneWithoutGaps) {
  const std::vector<double> out = speeds_after(cradle(0, 1), 1.0 / 60);
  for (std::size_t i = 0; i < balls; ++i) EXPECT_NEAR(out[i], i == 0 ? -0.6 : 0.4, 1e-5) << i;
}

}  // namespace
}  // namespace plumb::PLUMB_TEST_FILE
