// What the settings of contact and sleep do.

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "support/bodies.hpp"

namespace plumb::PLUMB_TEST_FILE {
namespace {

using test::frame;

/// A limb that falls askew on a floor, and a ball that rolls into it; lengths are in units of 1 / `scale` m.
Scene in_units(double scale) {
  Scene scene;
  const Surface surface{.friction = 0.4, .restitution = 0.3};
  scene.gravity = scale * scene.gravity;
  scene.planes.push_back({.surface = surface});
  test::add_capsule_rod(scene, scale * Vec3{-0.5, 0.3, 0}, scale * Vec3{0.4, 0.5, 0.2}, 2, scale * 0.05,
                        surface);
  test::add_ball(scene, scale * Vec3{-1.5, 0.1, 0.1}, scale * 0.1, 1, scale * Vec3{3, 0, 0}, surface);
  return scene;
}

// The unit of length is the user's choice. By a power of two, all numbers keep their digits.
TEST(ContactSettings, LengthScaleMakesUnitsAMatterOfChoice) {
  Settings settings = test::body_settings(1, true);
  World world(in_units(1), settings);
  constexpr double scale = 64;
  settings.contact.length_scale = scale;
  World scaled(in_units(scale), settings);
  for (int step = 0; step < 90; ++step) {
    const StepReport report = world.step(frame), report_scaled = scaled.step(frame);
    EXPECT_EQ(report.contact_points, report_scaled.contact_points) << step;
    EXPECT_EQ(report.newton, report_scaled.newton) << step;
  }
  for (std::uint32_t i = 0; i < world.particle_count(); ++i)
    EXPECT_LT(norm(scaled.position(i) - scale * world.position(i)), scale * 1e-9) << i;
}

TEST(ContactSettings, SleepTimeIsWaitedFor) {
  const auto steps_awake = [](double sleep_time) {
    Settings settings = test::body_settings(1, true);
    settings.sleep_time = sleep_time;
    Scene scene;
    scene.planes.push_back({});
    test::add_ball(scene, {0, 0.1, 0}, 0.1, 1, {}, {});
    World world(scene, settings);
    int steps = 0;
    while (world.step(frame).awake_islands > 0 && steps < 1000) ++steps;
    return steps;
  };
  const int shorter = steps_awake(0.2), longer = steps_awake(1);
  EXPECT_NEAR((longer - shorter) * frame, 0.8, 1.5 * frame);
}

// Nothing that is slower than the bounce speed bounces, whatever its restitution.
TEST(ContactSettings, BounceSpeedTellsWhatBounces) {
  const auto highest_after_hit = [](double bounce_speed) {
    Settings settings = test::body_settings(1, false);
    settings.contact.bounce_speed = bounce_speed;
    const Surface elastic{.restitution = 1};
    Scene scene;
    scene.planes.push_back({.surface = elastic});
    test::add_ball(scene, {0, 0.3, 0}, 0.1, 1, {}, elastic);  // arrives at 1.98 m/s
    World world(scene, settings);
    double highest = 0;
    for (int step = 0; step < 24; ++step) {
      world.step(frame);
      if (step > 13) highest = std::max(highest, world.position(0).y);
    }
    return highest;
  };
  EXPECT_GT(highest_after_hit(1.9), 0.2);
  EXPECT_LT(highest_after_hit(2.1), 0.11);
}

// An overlap decays by the recovery in a substep, and exponentially where substeps are cut.
TEST(ContactSettings, RecoveryTellsHowFastOverlapEnds) {
  for (const double recovery : {0.05, 0.2}) {
    Settings settings = test::body_settings(1, false);
    settings.contact.recovery = recovery;
    Scene scene;
    scene.planes.push_back({});
    test::add_ball(scene, {0, 0.08, 0}, 0.1, 1, {}, {});
    World world(scene, settings);
    const double slop = settings.contact.slop;
    double beyond = 0.02 - slop;
    for (int step = 0; step < 5; ++step) {
      world.step(frame);
      const double left = 0.1 - world.position(0).y - slop;
      EXPECT_GE(left, (1 - recovery) * beyond - 1e-9) << recovery << ", step " << step;
      EXPECT_LE(left, std::exp(-recovery) * beyond + 1e-9) << recovery << ", step " << step;
      beyond = left;
    }
  }
}

}  // namespace
}  // namespace plumb::PLUMB_TEST_FILE
