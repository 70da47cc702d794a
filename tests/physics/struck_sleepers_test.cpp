// A blow to what sleeps goes on as it would if all were awake.

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <vector>

#include "support/bodies.hpp"

namespace plumb::PLUMB_TEST_FILE {
namespace {

using test::frame;

/// What a blow leaves.
struct After {
  std::vector<Vec3> velocities;  ///< m/s, of particles
  double deepest = 0;            ///< m, of balls in each other at the ends of steps
};

/// Steps through a blow by the last ball of a scene. The others stand, and sleep if that is allowed.
After strike(Scene scene, Settings settings, bool sleeps) {
  settings.sleep = sleeps;
  settings.threads = 1;
  for (Particle& particle : scene.particles) particle.asleep = sleeps && &particle != &scene.particles.back();
  World world(scene, settings);
  const auto count = static_cast<std::uint32_t>(scene.particles.size());
  After out;
  for (int i = 0; i < 10; ++i) {
    world.step(frame);
    for (std::uint32_t a = 0; a < count; ++a)
      for (std::uint32_t b = a + 1; b < count; ++b)
        out.deepest = std::max(out.deepest, scene.capsules[a].radius + scene.capsules[b].radius -
                                                norm(world.position(a) - world.position(b)));
  }
  for (std::uint32_t a = 0; a < count; ++a) out.velocities.push_back(world.velocity(a));
  return out;
}

/// Expects that sleeping changes nothing: all are awake before anything is pushed. Contacts may be found in
/// another order, which left 3e-12 m/s beside 100 m/s.
After expect_alike(const Scene& scene, const Settings& settings) {
  const After awake = strike(scene, settings, false), slept = strike(scene, settings, true);
  EXPECT_NEAR(slept.deepest, awake.deepest, 1e-12);
  for (std::size_t i = 0; i < awake.velocities.size(); ++i)
    EXPECT_LT(norm(slept.velocities[i] - awake.velocities[i]), 1e-11) << "ball " << i;
  return slept;
}

/// Balls in a row, `gap` (m) apart, at which one more comes `speed` (m/s) fast, half a step away.
Scene row(int count, double radius, double gap, double speed, double restitution) {
  const Surface surface{.friction = 0.2, .restitution = restitution};
  Scene scene;
  scene.gravity = {};
  for (int i = 0; i < count; ++i)
    test::add_ball(scene, {i * (2 * radius + gap), 0, 0}, radius, 1, {}, surface);
  test::add_ball(scene, {-2 * radius - 0.5 * frame * speed, 0, 0}, radius, 1, {speed, 0, 0}, surface);
  return scene;
}

// Nine balls touch, or nearly so. The blow goes through all of them in one step, and far beyond what the ball
// that comes can reach.
TEST(StruckSleepers, PassABlowThroughAHeap) {
  for (const std::uint32_t substeps : {1u, 4u})
    for (const double speed : {3.0, 10.0, 20.0})
      for (const double restitution : {0.0, 1.0})
        for (const double gap : {0.0, 1e-3}) {
          const Scene scene = row(9, 0.1, gap, speed, restitution);
          SCOPED_TRACE(testing::Message() << substeps << " substeps, " << speed << " m/s, restitution "
                                          << restitution << ", gap " << gap);
          const After solved = expect_alike(scene, {.method = Method::direct, .substeps = substeps});
          EXPECT_LT(solved.deepest, ContactSettings{}.slop);
          expect_alike(scene, {.method = Method::relax, .substeps = substeps});
        }
}

/// A ball is struck 45° off its middle by one that comes along x. Another one is `way` (m) off where it goes.
Scene corner(double mass, double way, double speed, double restitution) {
  constexpr double radius = 0.02;
  const Surface surface{.friction = 0, .restitution = restitution};
  const Vec3 along{std::sqrt(0.5), 0, std::sqrt(0.5)};
  Scene scene;
  scene.gravity = {};
  test::add_ball(scene, {}, radius, mass, {}, surface);
  test::add_ball(scene, (2 * radius + way) * along, radius, 1, {}, surface);
  test::add_ball(scene, -2 * radius * along - Vec3{0.02 * frame * speed, 0, 0}, radius, 1, {speed, 0, 0},
                 surface);
  return scene;
}

// The second ball is out of the way of the one that comes. It wakes as the first is pushed into it.
TEST(StruckSleepers, PassABlowOnFromOneToTheNext) {
  for (const Method method : {Method::direct, Method::relax})
    for (const double speed : {3.0, 10.0, 20.0})
      for (const double restitution : {0.0, 1.0}) {
        SCOPED_TRACE(testing::Message()
                     << to_string(method) << ", " << speed << " m/s, restitution " << restitution);
        expect_alike(corner(1, 0.005, speed, restitution), {.method = method});
      }
}

// A light ball is thrown at more than 100 m/s within the step. It would be beyond the second one at its end.
TEST(StruckSleepers, AreNotPassed) {
  for (const Method method : {Method::direct, Method::relax}) {
    SCOPED_TRACE(to_string(method));
    const After after = expect_alike(corner(0.1, 0.1, 90, 1), {.method = method});
    EXPECT_GT(norm(after.velocities[1]), 1) << "it was struck";
  }
}

// Who stands beside a heap that is struck, and is not touched, sleeps on.
TEST(StruckSleepers, LetOthersSleep) {
  for (const Method method : {Method::direct, Method::relax}) {
    Scene scene = row(3, 0.1, 0, 20, 0);
    test::add_ball(scene, {-0.1, 0, 0.25}, 0.1, 1);
    for (Particle& particle : scene.particles) particle.asleep = particle.velocity == Vec3{};
    World world(scene, {.method = method, .threads = 1});
    EXPECT_EQ(world.step(frame).awake_islands, 4u) << to_string(method);
    EXPECT_EQ(world.velocity(4), Vec3{});
  }
}

}  // namespace
}  // namespace plumb::PLUMB_TEST_FILE
