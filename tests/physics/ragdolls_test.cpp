// Ragdolls of bodies and ball joints fall on a plane, and lie there in the end.
#include "support/ragdolls.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cstdint>

#include "plumb/plumb.hpp"
#include "support/bodies.hpp"

namespace plumb::PLUMB_TEST_FILE {
namespace {

constexpr double frame = 1.0 / 60;

/// Places of contact that slide push along the edge of Coulomb's cone. Sweeps that do not see it went back
/// and forth for ever here, and a frame took 16,000 of them.
TEST(Ragdoll, FallsFromAnyHeightWithoutASpike) {
  for (int i = 0; i < 24; ++i) {
    const double height = 1 + 0.02 * i;
    Scene scene;
    scene.joint_drag = 3;
    scene.planes.push_back({});
    test::add_ragdoll(scene, {0, height, 0});
    World world(scene, {.threads = 1});
    bool is_awake = true;
    for (int k = 0; is_awake && k < 600; ++k) {
      const StepReport report = world.step(frame);
      EXPECT_EQ(report.unsolved, 0u) << height << ", " << k;
      EXPECT_LE(report.newton, 300u) << height << ", " << k;
      EXPECT_LE(report.block_sweeps, 3000u) << height << ", " << k;
      is_awake = report.awake_islands > 0;
    }
    EXPECT_FALSE(is_awake) << height;
  }
}

/// What ends all overlaps at once may not be there. Each then yields to the others, and both come apart.
TEST(Ragdoll, ComesApartFromAnotherInItsPlace) {
  for (const double apart : {0.0, 1e-6, 1e-3, 0.01, 0.03}) {
    Scene scene;
    scene.joint_drag = 3;
    scene.planes.push_back({});
    const std::uint32_t one = test::add_ragdoll(scene, {0, 0.5, 0});
    const std::uint32_t two = test::add_ragdoll(scene, {apart, 0.5, 0.5 * apart});
    World world(scene, {.threads = 1});
    StepReport total{};
    const auto top_speed = [&] {
      double out = 0;
      for (std::uint32_t i = 0; i < world.particle_count(); ++i) out = std::max(out, norm(world.velocity(i)));
      return out;
    };
    double fastest = 0;
    for (int k = 0; k < 420; ++k) {
      total += world.step(frame);
      fastest = std::max(fastest, top_speed());
    }
    EXPECT_EQ(total.unsolved, 0u) << apart;
    EXPECT_LE(total.newton, 40000u) << apart;
    EXPECT_LT(fastest, 30) << apart;       // Falling 2.2 m, and a hand that whips, take them to 15.
    EXPECT_LT(top_speed(), 0.2) << apart;  // Limbs that are entangled tremble at 0.08.
    // The axes of two torsos of radius 0.12 that lie are no higher than two of them.
    for (const std::uint32_t torso : {one, two}) EXPECT_LT(world.pose(torso).position.y, 0.37) << apart;
  }
}

/// A lift comes down on one that stands upright, so that no push turns any limb, to where it may lie. Its
/// joints opened by up to 3.9 m before, and often stayed so.
TEST(Ragdoll, StaysWholeBelowALift) {
  for (const double speed : {0.3, 0.6, 1.0, 2.0})
    for (const double leans : {0.0, 1e-3}) {
      SCOPED_TRACE(testing::Message() << speed << " m/s, leans " << leans);
      Scene scene;
      scene.joint_drag = 1;
      scene.planes.push_back({});
      scene.platforms.emplace_back();
      scene.boxes.push_back({.center = {0, 2.1, 0}, .half_size = {3, 0.1, 3}, .motion = {.platform = 0}});
      test::add_ragdoll(scene, {0, 0, 0});
      for (Particle& each : scene.particles) each.velocity = {leans, 0, 0.5 * leans};
      World world(scene, {.threads = 1});
      StepReport total;
      for (int k = 1; k <= 480; ++k) {
        world.move_platform(0, {.position = {0, -std::min(1.4, speed * k * frame), 0}});
        total += world.step(frame);
      }
      EXPECT_EQ(total.frozen_islands, 0u);
      double open = 0;
      for (const Pin& pin : scene.pins)
        open = std::max(open, norm(test::place_of(world, pin.a) - test::place_of(world, pin.b)));
      EXPECT_LT(open, 1e-6);
    }
}

}  // namespace
}  // namespace plumb::PLUMB_TEST_FILE
