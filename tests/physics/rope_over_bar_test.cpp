// A rope of rods slides over a smooth bar as over a pulley.

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <numbers>
#include <vector>

#include "plumb/plumb.hpp"
#include "support/worlds.hpp"

namespace plumb::PLUMB_TEST_FILE {
namespace {

constexpr double bar = 0.2, thick = 0.015, hangs = 1.4, light_end = 5;

/// A rope of about so long rods (m) whose particles weigh `mass` (kg). It hangs down from a bar along z on
/// both sides, with 5 kg at one end and `ratio` times that at the other.
Scene rope_over_bar(double rod, double mass, double ratio) {
  const int around = static_cast<int>(std::lround(std::numbers::pi * (bar + thick) / rod));
  const int down = static_cast<int>(std::lround(hangs / rod));
  const double turn = std::numbers::pi / around, far = (bar + thick) / std::cos(turn / 2);
  Scene scene;
  scene.ground_capsules.push_back({{0, 0, -0.5}, {0, 0, 0.5}, bar});
  scene.ground_capsules.back().surface.friction = 0;
  for (int i = -down; i <= around + down; ++i) {
    const double angle = turn * std::clamp(i, 0, around);
    const double below = hangs / down * std::max({0, -i, i - around});
    const double weighs = i == -down ? light_end : i == around + down ? ratio * light_end : mass;
    const auto here = static_cast<std::uint32_t>(scene.particles.size());
    scene.particles.push_back(
        test::movable({-far * std::cos(angle), far * std::sin(angle) - below, 0}, weighs));
    if (here == 0) continue;
    scene.rods.push_back({.a = here - 1, .b = here});
    scene.capsules.push_back({.a = point_at(here - 1), .b = point_at(here), .radius = thick});
    scene.capsules.back().surface.friction = 0;
  }
  return scene;
}

/// Returns how far (m) the light end rises in a time (s). What comes over to the other side adds to its
/// weight.
double rise(const Scene& scene, double mass, double ratio, double time) {
  double all = 0;
  for (const Particle& each : scene.particles) all += each.mass;
  const double per_length = mass / norm(scene.particles[1].position - scene.particles[0].position);
  const double rate = std::sqrt(2 * per_length * test::earth / all);
  return (ratio - 1) * light_end / (2 * per_length) * (std::cosh(rate * time) - 1);
}

// Rods rock on a bar as stiffly as waves run along a rope. Contacts that kept to where rods touched as a
// substep began rocked them more and more, and the rope came to a halt: of five of these it went 4 to 29 % of
// the way. What is left is of the first order in the substep, in which rods turn by up to a third of a
// corner.
TEST(RopeOverBar, SlidesAsOverAPulley) {
  struct Case {
    double rod, mass, ratio;
    std::uint32_t substeps;
    double tolerance;
  };
  for (const Case& of :
       {Case{0.08, 0.02, 1.2, 1, 0.15}, Case{0.12, 0.02, 1.2, 1, 0.15}, Case{0.04, 0.02, 1.2, 1, 0.15},
        Case{0.12, 0.02, 1.05, 1, 0.1}, Case{0.08, 1, 1.2, 1, 0.1}, Case{0.08, 0.02, 1.2, 4, 0.06}}) {
    SCOPED_TRACE(testing::Message() << of.rod << " m, " << of.mass << " kg, ratio " << of.ratio);
    const Scene scene = rope_over_bar(of.rod, of.mass, of.ratio);
    World world(scene, {.substeps = of.substeps, .threads = 1});
    const double start = world.position(0).y;
    const StepReport report = test::run(world, test::frame, 90);
    const double truth = rise(scene, of.mass, of.ratio, 1.5);
    EXPECT_NEAR(world.position(0).y - start, truth, of.tolerance * truth);
    EXPECT_EQ(report.unsolved + report.elastic_substeps, 0u);
  }
}

}  // namespace
}  // namespace plumb::PLUMB_TEST_FILE
