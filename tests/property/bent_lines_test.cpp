// Lines with bends in lanes: their law and their places against those of any island, and both solvers'
// motion.

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <numbers>
#include <vector>

#include "direct/bends/bend_law.hpp"
#include "direct/bends/line_bends.hpp"
#include "direct/bends/tree_bends.hpp"
#include "plumb/plumb.hpp"
#include "support/graphs.hpp"
#include "support/line_trees.hpp"
#include "support/worlds.hpp"

// Every body is made of those before it.
// clang-format off
#include "simd/tree/one_lane.hpp"
#include "simd/tree/tree_lanes.hpp"
#include "simd/tree/lines/bend_lanes.hpp"
#include "simd/tree/lines/bent_lanes.hpp"
// clang-format on

namespace plumb::PLUMB_TEST_FILE {
namespace {

using test::fixed;
using test::movable;

Vec3 random_vector(test::Random& random, double size) {
  const double x = test::signed_unit(random), y = test::signed_unit(random), z = test::signed_unit(random);
  return size * Vec3{x, y, z};
}
simd::Vec<double> of_lane(Vec3 v) {
  return {v.x, v.y, v.z};
}

// Some bends begin or end where rods fold, some are straight, and some stand still. Rounding of what is
// compared is that of quotients of small differences where rods fold.
TEST(BentLines, LanesHaveTheLawOfBends) {
  test::Random random(3);
  for (int i = 0; i < 600; ++i) {
    const double rest = i % 3 == 0 ? 0.8 : 0, damping = i % 2 == 0 ? 1.5 : 0, theta = i % 4 < 2 ? 0.5 : 1;
    const Vec3 start = i % 17 == 0 ? Vec3{} : random_vector(random, i % 5 == 0 ? 1.9 : 1.1);
    const Vec3 change = i % 17 == 0 ? Vec3{} : random_vector(random, i % 7 == 0 ? 1e-3 : 0.9);
    const detail::BendNumbers numbers{{-1, 2, -1}, 3, rest, damping};
    const detail::BendPull wanted = detail::bend_pull(numbers, {0.5, 0.25, theta}, start, change);
    const simd::BendNumbers<double> bend{-1, 2, -1, 3, rest, damping};
    const simd::BendFactors<double> factors{0.5, 0.25, theta};
    const auto got =
        theta < 1
            ? simd::bend_pull_of<true, double>(bend, factors, damping > 0, of_lane(start), of_lane(change))
            : simd::bend_pull_of<false, double>(bend, factors, damping > 0, of_lane(start), of_lane(change));
    const double slope[9] = {got.slope.v0.x, got.slope.v1.x, got.slope.v2.x, got.slope.v0.y, got.slope.v1.y,
                             got.slope.v2.y, got.slope.v0.z, got.slope.v1.z, got.slope.v2.z};
    double size = 1;
    for (const double each : wanted.slope) size = std::max(size, std::abs(each));
    EXPECT_NEAR(got.pull.x, wanted.pull.x, 1e-12 * size) << i;
    EXPECT_NEAR(got.pull.y, wanted.pull.y, 1e-12 * size) << i;
    EXPECT_NEAR(got.pull.z, wanted.pull.z, 1e-12 * size) << i;
    for (int k = 0; k < 9; ++k) EXPECT_NEAR(slope[k], wanted.slope[k], 1e-11 * size) << i << ' ' << k;
  }
}

TEST(BentLines, FindTheirPlaces) {
  const layouts::Tree tree = test::line_tree(4, 3);
  // Vertices 4 and 5 are the anchors, 6 and 7 the clamps.
  const auto found = detail::find_line_bends(
      tree, {{{{6, 4, 0}}, {{1, 0, 4}}, {{0, 1, 2}}, {{5, 3, 2}}, {{3, 5, 7}}}, {}, {}});
  ASSERT_TRUE(found.has_value());
  EXPECT_EQ(found->slots, (Array<std::uint32_t>{0, 1, 2, 4, 5}));
  EXPECT_EQ(found->turned, (Array<std::uint8_t>{0, 1, 0, 1, 0}));
  EXPECT_EQ(found->clamps, (Array<std::uint32_t>{6, 7}));
  EXPECT_EQ(found->ends, (std::array<std::uint32_t, 4>{2, 0, 1, 3}));
}

TEST(BentLines, AreNotFoundElsewhere) {
  const auto found = [](const layouts::Tree& tree, const detail::LoopElements& elements) {
    return detail::find_line_bends(tree, elements).has_value();
  };
  const layouts::Tree tree = test::line_tree(4, 1);
  EXPECT_TRUE(found(tree, {{{{0, 1, 2}}}, {}, {}}));
  EXPECT_FALSE(found(tree, {{{{0, 1, 3}}}, {}, {}})) << "not in turn";
  EXPECT_FALSE(found(tree, {{{{0, 1, 2}}, {{2, 1, 0}}}, {}, {}})) << "two at one place";
  EXPECT_FALSE(found(tree, {{{{6, 5, 3}}}, {}, {}})) << "no anchor at the tip";
  EXPECT_FALSE(found(tree, {{{{0, 1, 2}}}, {{{0, 2}, 0}}, {}})) << "a tackle";
  layouts::Tree branched = tree;
  branched.parent[3] = 1;
  EXPECT_FALSE(found(branched, {{{{0, 1, 2}}}, {}, {}}));
}

/// Equal wires side by side, which differ in how they move. `ends` are clamped as in test::line_tree(). Their
/// first rods break at `strength` (N).
Scene wires(std::uint32_t count, int ends, double strength) {
  constexpr std::uint32_t rods = 7;
  constexpr double l = 0.1;
  test::Random random(11);
  Scene scene;
  scene.drag = 0.1;
  for (std::uint32_t w = 0; w < count; ++w) {
    const auto first = static_cast<std::uint32_t>(scene.particles.size());
    for (std::uint32_t i = 0; i < rods + 3; ++i) {
      const Vec3 at{l * (i - 1.0), 0.01 * (i % 2), 0.3 * w};
      const bool is_fixed = ((ends & 1) != 0 && i <= 1) || ((ends & 2) != 0 && i >= rods + 1);
      scene.particles.push_back(is_fixed ? fixed(at) : movable(at, 0.02 * (1 + i % 3)));
      if (!is_fixed) scene.particles.back().velocity = random_vector(random, 0.3);
    }
    for (std::uint32_t i = 0; i < rods + 2; ++i) {
      const bool both = scene.particles[first + i].fixed && scene.particles[first + i + 1].fixed;
      if (both) continue;
      Rod rod{.a = first + i, .b = first + i + 1, .mass = i % 2 == 0 ? 0.01 : 0};
      if (i % 3 == 2) rod.law = {.stiffness = 4e3, .damping = 0.2};
      if (i == 3) rod.law.strength = strength;
      scene.rods.push_back(rod);
    }
    for (std::uint32_t i = 0; i < rods + 1; ++i) {
      Bend bend{first + i, first + i + 1, first + i + 2, 0.05 * (1 + i % 2)};
      if (i % 2 == 1) std::swap(bend.a, bend.c);
      if (i % 4 == 2) bend.angle = 0.4;
      bend.damping = i % 3 == 1 ? 1e-3 : 0;
      scene.bends.push_back(bend);
    }
  }
  return scene;
}

// A rod with a strength sends its island to the solver for any island, which has the same equations. Both
// solve them to rounding, 1e-8 of a rod in an iteration that converges by squares.
TEST(BentLines, MoveAsIslandsOfAnyShapeDo) {
  constexpr double never = std::numeric_limits<double>::infinity();
  for (const Gradient gradient : {Gradient::mid, Gradient::new_})
    for (const int ends : {0, 1, 2, 3}) {
      const Settings settings{
          .method = Method::direct, .gradient = gradient, .substeps = 4, .tensions = true, .threads = 1};
      const Scene start = wires(9, ends, never);
      World lines(start, settings), islands(wires(9, ends, 1e30), settings);
      for (World* const world : {&lines, &islands}) {
        for (int i = 0; i < 30; ++i) {
          if (ends != 3 && gradient == Gradient::new_) world->set_length(2, rod_length(start, 2) + 1e-3 * i);
          if ((ends & 1) != 0 && gradient == Gradient::new_) world->move_anchor(0, {-0.1, 2e-3 * i, 0});
          const StepReport report = world->step(1.0 / 60);
          EXPECT_EQ(report.unsolved + report.fallbacks + report.elastic_substeps, 0u);
        }
      }
      double apart = 0, moved = 0;
      for (std::uint32_t i = 0; i < lines.particle_count(); ++i) {
        apart = std::max(apart, norm(lines.position(i) - islands.position(i)));
        moved = std::max(moved, norm(lines.position(i) - start.particles[i].position));
        if (start.particles[i].fixed) {
          EXPECT_LE(norm(lines.reaction(i) - islands.reaction(i)), 1e-6 * (1 + norm(islands.reaction(i))))
              << i;
        }
      }
      EXPECT_LE(apart, 1e-9) << to_string(gradient) << ' ' << ends;
      EXPECT_GT(moved, 1e-2);
      for (std::uint32_t i = 0; i < lines.rod_count(); ++i)
        EXPECT_NEAR(lines.tension(i), islands.tension(i), 1e-6 * (1 + std::abs(islands.tension(i)))) << i;
    }
}

TEST(BentLines, HaveTheSameBitsInLanesAndAlone) {
  constexpr double never = std::numeric_limits<double>::infinity();
  const auto positions = [&](std::uint32_t count, Isa isa) {
    World world(wires(count, 1, never), {.isa = isa, .threads = 1});
    test::run(world, 1.0 / 60, 20);
    std::vector<Vec3> out;
    for (std::uint32_t i = 0; i < 10; ++i) out.push_back(world.position(i));
    return out;
  };
  const std::vector<Vec3> alone = positions(1, Isa::scalar);
  EXPECT_EQ(positions(1, best_isa()), alone);
  EXPECT_EQ(positions(20, best_isa()), alone);
  EXPECT_EQ(positions(20, Isa::scalar), alone);
}

}  // namespace
}  // namespace plumb::PLUMB_TEST_FILE
