// Loads that hang from light ropes and swing past things without touching them.

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdint>

#include "plumb/measures.hpp"
#include "plumb/plumb.hpp"
#include "support/worlds.hpp"

namespace plumb::PLUMB_TEST_FILE {
namespace {

constexpr double frame = 1.0 / 60, thin = 0.02;
constexpr std::uint32_t links = 10;

/// Appends a rope of 1 m and capsules from an anchor, 50 g a link, with a load. Returns its first particle.
std::uint32_t hang(Scene& scene, Vec3 from, Vec3 along, double load) {
  const auto first = static_cast<std::uint32_t>(scene.particles.size());
  for (std::uint32_t i = 0; i <= links; ++i)
    scene.particles.push_back(
        {.position = from + (0.1 * i) * along, .mass = i == links ? load : 0.05, .fixed = i == 0});
  for (std::uint32_t i = 0; i < links; ++i) {
    scene.rods.push_back({.a = first + i, .b = first + i + 1});
    scene.capsules.push_back({.a = point_at(first + i), .b = point_at(first + i + 1), .radius = thin});
  }
  return first;
}

double energy_of(const Scene& scene, const World& world) {
  return measure_energy(scene, test::positions_of(world), test::velocities_of(world)).total();
}

/// Lets a scene swing for 20 s. Nothing may touch, and energy is kept to what is left of corrections, some
/// 1e-8 of it.
void expect_free_swing(const Scene& scene, double range) {
  World world(scene, {.threads = 1});
  const double before = energy_of(scene, world);
  StepReport report;
  double lost = 0;
  for (int i = 0; i < 1200; ++i) {
    report += world.step(frame);
    lost = std::max(lost, std::abs(energy_of(scene, world) - before));
  }
  EXPECT_EQ(report.contact_points, 0u);
  EXPECT_EQ(report.trimmed_energy, 0u);
  EXPECT_LT(report.newton, 50'000u);  // 40 a step of two ropes
  EXPECT_LT(lost, 1e-6 * range);
}

// Before, gradient old moved what something was near. Its waves along light rods fed on the swing of the
// load, and the guard of energy took that away: all of it in 15 s.
TEST(NearMisses, KeepASwingBesideARope) {
  for (const double load : {2.0, 20.0})
    for (const double gap : {0.03, 0.05}) {
      SCOPED_TRACE(testing::Message() << load << " kg at " << gap << " m");
      Scene scene;
      hang(scene, {0, 4, 0}, {0.6, -0.8, 0}, load);
      hang(scene, {0, 4, gap + 2 * thin}, {0, -1, 0}, 0.05);
      expect_free_swing(scene, load * 9.81 * 0.2);
    }
}

TEST(NearMisses, KeepASwingAboveAFloor) {
  Scene scene;
  scene.planes.push_back({.offset = 3 - thin - 0.01});
  hang(scene, {0, 4, 0}, {0.6, -0.8, 0}, 2);
  expect_free_swing(scene, 2 * 9.81 * 0.2);
}

// Half of a rope becomes a line between two fixed ends that is straight to 1e-6, with a load below it that
// swings on. Before, that stood still after two frames, and 98 kN pulled in the line.
TEST(NearMisses, KeepASwingBelowALineThatIsTaut) {
  Scene scene;
  hang(scene, {0, 4, 0}, {0.6, -0.8, 0}, 2);
  World world(scene, {.threads = 1});
  for (int i = 0; i < 10; ++i) world.step(frame);
  world.fix(links / 2);
  world.step(frame);
  double highest = -1, fastest = 0;
  for (int i = 0; i < 240; ++i) {
    EXPECT_EQ(world.step(frame).unsolved, 0u);
    if (i >= 180) highest = std::max(highest, world.position(links).y);
    fastest = std::max(fastest, norm(world.velocity(links)));
  }
  EXPECT_GT(highest, 4 - 0.8 - 0.05) << "it comes back to nearly where it was fixed";
  EXPECT_LT(fastest, 4) << "as fast as it may become by falling 0.8 m";
}

}  // namespace
}  // namespace plumb::PLUMB_TEST_FILE
