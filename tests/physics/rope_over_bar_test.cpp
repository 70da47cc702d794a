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

/// A rope of about so long rods (m) whose particles weigh `mass` (kg). It hangs down on both sides from where
/// a bar along z is to be, with 5 kg at one end and `ratio` times that at the other.
Scene rope(double rod, double mass, double ratio, double friction) {
  const int around = static_cast<int>(std::lround(std::numbers::pi * (bar + thick) / rod));
  const int down = static_cast<int>(std::lround(hangs / rod));
  const double turn = std::numbers::pi / around, far = (bar + thick) / std::cos(turn / 2);
  Scene scene;
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
    scene.capsules.back().surface.friction = friction;
  }
  return scene;
}

Scene rope_over_bar(double rod, double mass, double ratio) {
  Scene scene = rope(rod, mass, ratio, 0);
  scene.ground_capsules.push_back({{0, 0, -0.5}, {0, 0, 0.5}, bar});
  scene.ground_capsules.back().surface.friction = 0;
  return scene;
}

/// The rope's bar is a body of 1 kg, which turns on two pins.
Scene rope_over_pulley(double rod, double mass, double ratio, double friction) {
  Scene scene = rope(rod, mass, ratio, friction);
  const double across = (3 * bar * bar + 1) / 12;
  const std::uint32_t pulley =
      add_body(scene, {.mass = 1, .inertia = {.xx = across, .yy = across, .zz = 0.5 * bar * bar}});
  const Vec3 ends[] = {{0, 0, -0.5}, {0, 0, 0.5}};
  const Point on_body[] = {point_on_body(scene, pulley, ends[0]), point_on_body(scene, pulley, ends[1])};
  for (int end = 0; end < 2; ++end) {
    scene.pins.push_back({on_body[end], point_at(static_cast<std::uint32_t>(scene.particles.size()))});
    scene.particles.push_back(test::fixed(ends[end]));
  }
  scene.capsules.push_back({.a = on_body[0], .b = on_body[1], .radius = bar});
  scene.capsules.back().surface.friction = friction;
  return scene;
}

/// Returns how far (m) the light end of a rope rises in a time (s), where it turns what resists as so much
/// mass (kg) would. What comes over to the other side adds to its weight.
double rise(const Scene& rope, double mass, double ratio, double turned, double time) {
  double all = turned;
  for (const Particle& each : rope.particles) all += each.mass;
  const double per_length = mass / norm(rope.particles[1].position - rope.particles[0].position);
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
    const double truth = rise(scene, of.mass, of.ratio, 0, 1.5);
    EXPECT_NEAR(world.position(0).y - start, truth, of.tolerance * truth);
    EXPECT_EQ(report.unsolved + report.elastic_substeps, 0u);
  }
}

// Here the bar is an island of its own, so that contacts are rows. Those kept to where rods touched, and the
// rope went 3 to 56 % of the way. On a rough pulley it sticks, and turns a cylinder as half its mass would
// move: what is lost is of the first order again.
TEST(RopeOverBar, RunsOverAPulleyOnAnAxle) {
  struct Case {
    double rod, mass, ratio, friction;
    std::uint32_t substeps;
    double tolerance;
  };
  for (const Case& of :
       {Case{0.08, 0.02, 1.2, 0, 1, 0.1}, Case{0.04, 0.02, 1.2, 0, 1, 0.1}, Case{0.12, 0.02, 1.05, 0, 1, 0.1},
        Case{0.08, 1, 1.2, 0, 1, 0.1}, Case{0.08, 0.1, 1.2, 0, 4, 0.05}, Case{0.08, 0.02, 1.2, 0.3, 4, 0.06},
        Case{0.08, 0.1, 1.2, 0.3, 4, 0.06}}) {
    SCOPED_TRACE(testing::Message() << of.rod << " m, " << of.mass << " kg, ratio " << of.ratio
                                    << ", friction " << of.friction);
    World world(rope_over_pulley(of.rod, of.mass, of.ratio, of.friction),
                {.substeps = of.substeps, .threads = 1});
    const double start = world.position(0).y;
    const StepReport report = test::run(world, test::frame, 90);
    const Scene alone = rope(of.rod, of.mass, of.ratio, of.friction);
    const double truth = rise(alone, of.mass, of.ratio, of.friction > 0 ? 0.5 : 0, 1.5);
    EXPECT_NEAR(world.position(0).y - start, truth, of.tolerance * truth);
    EXPECT_EQ(report.unsolved + report.elastic_substeps, 0u);
  }
}

/// A slack line of 50 rods with a rope of 40 over its middle, which has 0.2 kg at each end. Rods are 20 mm
/// long and as thick. `aside` (m) moves the rope.
Scene rope_over_line(double aside) {
  constexpr double rod = 0.02, radius = 0.01, bend = 0.025;
  Scene scene;
  const auto add = [&](Vec3 at, double mass, bool is_first) {
    const auto here = static_cast<std::uint32_t>(scene.particles.size());
    scene.particles.push_back(mass == 0 ? test::fixed(at) : test::movable(at, mass));
    if (is_first) return;
    scene.rods.push_back({.a = here - 1, .b = here});
    scene.capsules.push_back({.a = point_at(here - 1), .b = point_at(here), .radius = radius});
  };
  for (int i = -25; i <= 25; ++i)
    add({i * rod, 1.9 + 0.1 * 4 * (i * rod) * (i * rod), 0}, std::abs(i) == 25 ? 0 : 0.01, i == -25);
  constexpr double arc = bend * std::numbers::pi / 2, top = 1.9 + 2 * radius + 0.002 - bend;
  for (int i = -20; i <= 20; ++i) {
    const double along = i * rod, down = std::abs(along) - arc;
    const Vec3 at = down < 0 ? Vec3{0, top + bend * std::cos(along / bend), bend * std::sin(along / bend)}
                             : Vec3{0, top - down, std::copysign(bend, along)};
    add(at + Vec3{aside, 0, 0}, std::abs(i) == 20 ? 0.2 : 0.01, i == -20);
  }
  return scene;
}

// Rods that were brought to their lengths took the rope through the line, a few millimetres a frame, and all
// of these fell.
TEST(RopeOverBar, HangsOverASlackLine) {
  for (const double aside : {-1e-4, 0.0, 3e-5, 1e-4}) {
    World world(rope_over_line(aside), {.threads = 1});
    test::run(world, test::frame, 240);
    EXPECT_NEAR(world.position(51 + 20).y, 1.91, 0.03) << aside;
  }
}

}  // namespace
}  // namespace plumb::PLUMB_TEST_FILE
