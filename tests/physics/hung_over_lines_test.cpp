// Ropes and towels hang over a washing line, which sags less than it would if they were not there.

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <numbers>
#include <ostream>
#include <vector>

#include "plumb/plumb.hpp"
#include "scenes/basics/seeded.hpp"
#include "support/reactions.hpp"
#include "support/worlds.hpp"

namespace plumb::PLUMB_TEST_FILE {
namespace {

constexpr double rod = 0.05, thin = 0.005, thick = 0.01, gram = 1e-3;
constexpr int line_rods = 80;

void add_rod(Scene& scene, std::uint32_t a, std::uint32_t b, double radius) {
  scene.rods.push_back({.a = a, .b = b});
  scene.capsules.push_back({.a = point_at(a), .b = point_at(b), .radius = radius});
}

double height_of_line(double x) {
  constexpr double half = rod * line_rods / 2;
  return 2 - 0.05 * (half * half - x * x);
}

/// Says what hangs there: so many nets of so many lines, each of `rods` rods.
struct Washing {
  int pieces, lines, rods;

  friend std::ostream& operator<<(std::ostream& out, const Washing& of) {
    return out << of.pieces << " of " << of.lines << " lines of " << of.rods << " rods";
  }
};

/// Adds a net that lies on the line at `x` (m) and hangs down on both sides. Returns its middle particle.
std::uint32_t add_piece(Scene& scene, const Washing& of, double x, scenes::Random& random) {
  constexpr double bend = 0.03, arc = bend * std::numbers::pi / 2;
  const auto first = static_cast<std::uint32_t>(scene.particles.size());
  const auto row = static_cast<std::uint32_t>(of.rods + 1);
  for (int i = 0; i < of.lines; ++i) {
    const double here = x + rod * (i - 0.5 * (of.lines - 1));
    const double top = height_of_line(here) + 1.5 * (thin + thick) - bend;
    for (int j = 0; j <= of.rods; ++j) {
      const double along = rod * (j - 0.5 * of.rods), down = std::abs(along) - arc;
      const Vec3 at = down < 0
                          ? Vec3{here, top + bend * std::cos(along / bend), bend * std::sin(along / bend)}
                          : Vec3{here, top - down, std::copysign(bend, along)};
      const auto particle = static_cast<std::uint32_t>(scene.particles.size());
      scene.particles.push_back(test::movable(at + 1e-4 * random.in_cube(), 5 * gram));
      if (i > 0) add_rod(scene, particle - row, particle, thin);
      if (j > 0) add_rod(scene, particle - 1, particle, thin);
    }
  }
  return first + row * static_cast<std::uint32_t>(of.lines / 2) + row / 2;
}

class HungOverLines : public testing::TestWithParam<Washing> {};

// Where rods were relaxed and then brought to their lengths, the line came up through what lay on it: most
// towels fell, and every second of 30 ropes.
TEST_P(HungOverLines, HangAndRest) {
  Scene scene;
  for (std::uint32_t i = 0; i <= line_rods; ++i) {
    const double x = rod * (i - 0.5 * line_rods);
    const Vec3 at{x, height_of_line(x), 0};
    scene.particles.push_back(i % line_rods == 0 ? test::fixed(at) : test::movable(at, 20 * gram));
    if (i > 0) add_rod(scene, i - 1, i, thick);
  }
  scenes::Random random(1);
  std::vector<std::uint32_t> middles;
  const int pieces = GetParam().pieces;
  for (int k = 0; k < pieces; ++k)
    middles.push_back(add_piece(scene, GetParam(), 3.2 * ((k + 0.5) / pieces - 0.5), random));

  World world(scene, {.tensions = true, .threads = 1});
  const StepReport report = test::run(world, test::frame, 300);
  EXPECT_EQ(report.unsolved, 0u);
  EXPECT_EQ(report.elastic_substeps, 0u);
  EXPECT_EQ(world.step(test::frame).awake_islands, 0u);
  for (const std::uint32_t middle : middles) EXPECT_GT(world.position(middle).y, 1.75) << middle;
  std::vector<Vec3> positions(scene.particles.size());
  world.copy_positions(positions);
  EXPECT_LT(measure_stretch(scene, positions).max, 1e-6);  // what counts as unnoticed
  // What sleeps may accelerate by sleep_speed / (2 sleep_time) = 0.02 m/s². But for that the line's ends
  // carry what all weighs.
  double weight = 0;
  for (const Particle& each : scene.particles) weight += each.fixed ? 0 : each.mass * scene.gravity.y;
  EXPECT_NEAR(test::sum_of_reactions(world).y, -weight, 0.02 / 9.81 * std::abs(weight));
}

INSTANTIATE_TEST_SUITE_P(Washing, HungOverLines,
                         testing::Values(Washing{15, 1, 24}, Washing{30, 1, 24}, Washing{1, 11, 16},
                                         Washing{4, 7, 12}));

}  // namespace
}  // namespace plumb::PLUMB_TEST_FILE
