// Nets of rigid rods that are held at their corners catch what is far heavier than their particles.

#include <gtest/gtest.h>

#include <algorithm>
#include <cstdint>
#include <random>
#include <string>

#include "plumb/plumb.hpp"
#include "support/bodies.hpp"
#include "support/boxes.hpp"
#include "support/worlds.hpp"

namespace plumb::PLUMB_TEST_FILE {
namespace {

/// A net of n × n particles of 20 g that are 0.1 m apart, held at its corners, with capsules along its rods.
/// These are so many times as long as they look.
Scene net_by_corners(std::uint32_t n, double slack, double radius) {
  constexpr double apart = 0.1;
  Scene scene;
  const auto add_rod = [&](std::uint32_t a, std::uint32_t b) {
    scene.rods.push_back({.a = a, .b = b, .length = slack * apart});
    scene.capsules.push_back({.a = point_at(a), .b = point_at(b), .radius = radius});
  };
  for (std::uint32_t i = 0; i < n; ++i)
    for (std::uint32_t j = 0; j < n; ++j) {
      const bool is_corner = (i == 0 || i + 1 == n) && (j == 0 || j + 1 == n);
      const std::uint32_t at = i * n + j;
      scene.particles.push_back({.position = {apart * i, 0, apart * j}, .mass = 0.02, .fixed = is_corner});
      if (j > 0) add_rod(at - 1, at);
      if (i > 0) add_rod(at - n, at);
    }
  return scene;
}

/// A ball of 250 times a particle's mass presses on few of them. What sweeps left of that was taken for rods
/// that cannot be solved: frames took 4,400 corrections and 440 halvings.
TEST(CaughtByNets, IsABallWithoutASpike) {
  for (const std::uint32_t n : {8u, 12u}) {
    SCOPED_TRACE(n);
    Scene scene = net_by_corners(n, 1.05, 0.02);
    MassProperties ball = solid_sphere(5, 0.15);
    ball.center = {0.05 * (n - 1), 1, 0.05 * (n - 1)};
    const std::uint32_t body = add_body(scene, ball);
    scene.capsules.push_back(sphere_at(point_on_body(scene, body, ball.center), 0.15));
    World world(scene, {.threads = 1});
    StepReport total;
    std::uint64_t most = 0;
    for (int k = 0; k < 150; ++k) {
      const StepReport report = world.step(test::frame);
      most = std::max(most, report.newton);
      total += report;
      ASSERT_GT(world.pose(body).position.y, -0.1 * n) << "the ball is below what holds it, frame " << k;
    }
    EXPECT_LE(most, 2000u);
    EXPECT_EQ(total.unsolved + total.missed_contacts, 0u);
    EXPECT_LE(test::stretch_of(scene, world).max, 1e-7);
  }
}

/// Nets that hang straight, or nearly, hold nothing unless they stretch. Rods of those that can hold a crate
/// stayed strained by a fifth, since they were brought to their lengths through it, and frames took 400
/// halvings. Rods are relaxed to 1 % where they do not fit.
TEST(CaughtByNets, CratesOnTautOnesDoNotTearThem) {
  constexpr double half = 0.2;
  for (const std::uint32_t n : {9u, 11u})
    for (const double slack : {1.0, 1.0001, 1.001}) {
      SCOPED_TRACE(testing::Message() << n << ", " << slack);
      Scene scene = net_by_corners(n, slack, 0.01);
      const double middle = 0.05 * (n - 1);
      const std::uint32_t crate = test::add_box(scene, {middle + 0.02, half + 0.2, middle + 0.01},
                                                {half, half, half}, 4, {.friction = 0.5});
      World world(scene, {.threads = 1});
      StepReport total;
      double strain = 0;
      for (int k = 0; k < 80; ++k) {
        const StepReport report = world.step(test::frame);
        EXPECT_LE(report.halvings, 100u) << "frame " << k;
        total += report;
        strain = std::max(strain, test::stretch_of(scene, world).max);
      }
      EXPECT_LE(strain, 2e-2);
      EXPECT_EQ(total.unsolved, 0u);
      EXPECT_GT(world.pose(crate).position.y, -0.3) << "it is not through the net";
    }
}

/// What has drawn a net that hangs straight leaves it. Its rods were brought to their lengths within a
/// substep then, as a blow: energy rose by up to 65 J in a frame.
TEST(CaughtByNets, StraightOnesThatAreLeftGainNoEnergy) {
  for (const double speed : {2.0, 3.0})
    for (const std::uint32_t substeps : {1u, 4u}) {
      SCOPED_TRACE(testing::Message() << speed << " m/s, " << substeps);
      Scene scene = net_by_corners(9, 1, 0.01);
      const std::uint32_t crate = test::add_box(scene, {0.5, 0.25, 0.4}, {0.15, 0.15, 0.15}, 1, {});
      test::set_motion(scene, crate, {speed, 0, 0}, {});
      World world(scene, {.substeps = substeps, .threads = 1});
      const auto energy = [&] {
        return measure_energy(scene, test::positions_of(world), test::velocities_of(world),
                              MassModel::consistent)
            .total();
      };
      double last = energy();
      for (int k = 0; k < 120; ++k) {
        world.step(test::frame);
        EXPECT_LE(energy(), last + 0.05) << "frame " << k;
        last = energy();
      }
      EXPECT_LT(world.pose(crate).position.y, -1) << "it has left the net";
    }
}

/// A net with meshes of 0.12 m, held at its corners or not, and a crate that it lies in or cuts at the start.
Scene net_in_crate(std::uint64_t seed, bool is_held) {
  std::mt19937_64 random(seed);
  const auto draw = [&](double low, double high) {
    return low + (high - low) * static_cast<double>(random() >> 11) * 0x1p-53;
  };
  constexpr std::uint32_t n = 7;
  Scene scene;
  scene.planes.push_back({});
  for (std::uint32_t k = 0; k < n * n; ++k) {
    const std::uint32_t i = k % n, j = k / n;
    const bool is_corner = i % (n - 1) == 0 && j % (n - 1) == 0;
    scene.particles.push_back(
        {.position = {0.12 * i - 0.36, 2, 0.12 * j - 0.36}, .mass = 0.03, .fixed = is_held && is_corner});
    for (const std::uint32_t before : {i > 0 ? k - 1 : k, j > 0 ? k - n : k}) {
      if (before == k) continue;
      scene.rods.push_back({.a = before, .b = k});
      scene.capsules.push_back({.a = point_at(before), .b = point_at(k), .radius = 0.012});
    }
  }
  const double width = draw(0.12, 0.25), height = draw(0.1, 0.25), mass = draw(1, 10);
  const Vec3 center{draw(-0.3, 0.3), 2 + draw(-0.9, 0.9) * height, draw(-0.3, 0.3)},
      half{width, height, width};
  MassProperties crate = solid_box(mass, 2.0 * half);
  crate.center = center;
  const std::uint32_t body = add_body(scene, crate);
  scene.hulls.push_back(box_on_body(body, {.center = center, .half_size = half}));
  return scene;
}

/// Positions without overlaps were sought in ever shorter substeps, in up to 4.8 s for a frame, or not found,
/// and then all stood still. Relaxed, rods give way for a while. Crates land after 0.6 s, and one that lands
/// on an edge falls over within 0.8 s more. One that wraps the net round itself may take until 2 s. Of 96
/// seeds a frame took at most 2,212 corrections and halvings, and all frames 2,700 for each seed.
TEST(CaughtByNets, CratesThatStartInThemMoveOn) {
  constexpr std::uint64_t seeds = 8;
  std::uint64_t all = 0;
  for (const bool is_held : {false, true})
    for (std::uint64_t seed = 0; seed < seeds; ++seed) {
      SCOPED_TRACE("seed " + std::to_string(seed) + (is_held ? ", held" : ", free"));
      const Scene scene = net_in_crate(seed, is_held);
      World world(scene, {.threads = 1});
      StepReport total;
      std::uint64_t most = 0;
      for (int k = 0; k < (is_held ? 90 : 150); ++k) {
        const StepReport report = world.step(test::frame);
        most = std::max(most, report.newton + report.halvings);
        total += report;
      }
      EXPECT_LE(most, 4000u);
      all += total.newton + total.halvings;
      EXPECT_EQ(total.frozen_islands + total.unsolved, 0u);
      if (is_held) continue;  // and may lie on it
      EXPECT_LE(world.pose(0).position.y, 0.3) << "it lies on the ground";
      EXPECT_LE(test::stretch_of(scene, world).max, 1e-6);
    }
  EXPECT_LE(all, 2 * seeds * 4000);
}

}  // namespace
}  // namespace plumb::PLUMB_TEST_FILE
