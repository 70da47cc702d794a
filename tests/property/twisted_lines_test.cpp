// Lines with a twist in lanes: its law and its places against those of any island, both solvers' motion, and
// what gradient mid keeps.

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>
#include <utility>
#include <vector>

#include "direct/bends/line_bends.hpp"
#include "direct/bends/line_motion.hpp"
#include "direct/twists/tree_twists.hpp"
#include "direct/twists/twist_law.hpp"
#include "plumb/plumb.hpp"
#include "support/graphs.hpp"
#include "support/line_trees.hpp"
#include "support/worlds.hpp"

// Every body is made of those before it.
// clang-format off
#include "simd/tree/one_lane.hpp"
#include "simd/tree/tree_lanes.hpp"
#include "simd/tree/lines/bent_places.hpp"
#include "simd/tree/lines/twist_lanes.hpp"
#include "simd/tree/lines/torque_lanes.hpp"
#include "simd/tree/lines/bent_lanes.hpp"
// clang-format on

namespace plumb::PLUMB_TEST_FILE {
namespace {

using test::fixed;
using test::movable;

constexpr double never = std::numeric_limits<double>::infinity();

Vec3 random_vector(test::Random& random, double size) {
  const double x = test::signed_unit(random), y = test::signed_unit(random), z = test::signed_unit(random);
  return size * Vec3{x, y, z};
}

using Pair = simd::RodPair<double>;
Pair of_lane(const detail::RodPair& rods) {
  const auto [p, q] = rods;
  return {{p.x, p.y, p.z}, {q.x, q.y, q.z}};
}
detail::RodPair moved(const detail::RodPair& rods, double share, const detail::RodPair& by) {
  return {rods.first + share * by.first, rods.second + share * by.second};
}
void expect_near(const simd::Vec<double>& got, Vec3 wanted, double tolerance) {
  EXPECT_NEAR(got.x, wanted.x, tolerance);
  EXPECT_NEAR(got.y, wanted.y, tolerance);
  EXPECT_NEAR(got.z, wanted.z, tolerance);
}
void expect_near(const simd::Mat<double>& got, const std::array<double, 9>& wanted, double tolerance) {
  expect_near(got.v0, {wanted[0], wanted[3], wanted[6]}, tolerance);
  expect_near(got.v1, {wanted[1], wanted[4], wanted[7]}, tolerance);
  expect_near(got.v2, {wanted[2], wanted[5], wanted[8]}, tolerance);
}

/// Rods that meet, of about 1 m. Every fifth pair is folded.
detail::RodPair rods_of(test::Random& random, int i) {
  const Vec3 first = Vec3{1, 0.2, 0} + random_vector(random, 0.5);
  const Vec3 off = random_vector(random, i % 5 == 0 ? 0.05 : 0.8);
  return {first, i % 5 == 0 ? off - first : first + off};
}

// Rounding of what is compared is that of a few products of numbers up to the size of the slopes.
TEST(TwistedLines, LanesHaveTheLawOfTwists) {
  test::Random random(3);
  int folded = 0;
  for (int i = 0; i < 400; ++i) {
    SCOPED_TRACE(i);
    const detail::RodPair start = rods_of(random, i);
    const detail::RodPair change{random_vector(random, 0.01), random_vector(random, 0.01)};
    const detail::RodPair middle = moved(start, 0.5, change), end = moved(start, 1, change);
    folded += dot(middle.first, middle.second) < -0.97 * norm(middle.first) * norm(middle.second) ? 1 : 0;
    const auto mid = simd::twist_of_joint<true, double>(of_lane(start), of_lane(change));
    const auto at_end = simd::twist_of_joint<false, double>(of_lane(start), of_lane(change));
    for (const auto& [got, at] : {std::pair{mid, middle}, {at_end, end}}) {
      const detail::RodPair direction = detail::twist_direction(at);
      const auto slopes = detail::twist_slopes(at).of;
      double size = 1;
      for (const auto& row : slopes)
        for (const auto& each : row)
          for (const double number : each) size = std::max(size, std::abs(number));
      expect_near(got.pull.first, direction.first, 1e-14 * size);
      expect_near(got.pull.second, direction.second, 1e-14 * size);
      expect_near(got.slopes.first_first, slopes[0][0], 1e-13 * size);
      expect_near(got.slopes.first_second, slopes[0][1], 1e-13 * size);
      expect_near(got.slopes.second_first, slopes[1][0], 1e-13 * size);
      expect_near(got.slopes.second_second, slopes[1][1], 1e-13 * size);
    }
    const detail::RodPair direction = detail::twist_direction(middle);
    EXPECT_NEAR(mid.turn, dot(direction.first, change.first) + dot(direction.second, change.second), 1e-14);
    EXPECT_EQ(at_end.turn, mid.turn);
  }
  EXPECT_GE(folded, 20);
}

// The change of twist has the gradient that Newton's method takes. Differences are of second order, of a
// function whose third derivatives grow with the slopes.
TEST(TwistedLines, HaveTheGradientOfTheirTurn) {
  test::Random random(5);
  for (int i = 1; i < 60; i += i % 5 == 4 ? 2 : 1) {  // none is folded
    const detail::RodPair start = rods_of(random, i);
    const detail::RodPair change{random_vector(random, 0.2), random_vector(random, 0.2)};
    const detail::RodPair by{random_vector(random, 1), random_vector(random, 1)};
    const auto turn = [&](double step) {
      return simd::twist_of_joint<true, double>(of_lane(start), of_lane(moved(change, step, by))).turn;
    };
    const auto at = simd::twist_of_joint<false, double>(of_lane(start), of_lane(change));
    const double slope = dot(at.gradient, of_lane(by)), step = 1e-5;
    EXPECT_NEAR((turn(step) - turn(-step)) / (2 * step), slope, 1e-7 * (1 + std::abs(slope))) << i;
  }
}

using Joints = std::pair<std::uint32_t, std::uint32_t>;

TEST(TwistedLines, FindTheirPlaces) {
  const layouts::Tree tree = test::line_tree(4, 3);
  // Vertices 4 and 5 are the anchors, 6 and 7 the clamps.
  for (const bool turned : {false, true}) {
    Array<std::uint32_t> chain{6, 4, 0, 1, 2, 3, 5, 7};
    if (turned) std::reverse(chain.begin(), chain.end());
    const auto alone = detail::find_line_bends(tree, {{}, {}, {{chain}}, {}});
    ASSERT_TRUE(alone.has_value());
    EXPECT_EQ((Joints{alone->twist_begin, alone->twist_end}), (Joints{0, 6}));
    EXPECT_EQ(alone->clamps, (Array<std::uint32_t>{6, 7}));
    EXPECT_EQ(alone->ends, (std::array<std::uint32_t, 4>{2, 0, 1, 3}));
    const auto bent = detail::find_line_bends(tree, {{{{3, 5, 7}}}, {}, {{chain}}, {}});
    ASSERT_TRUE(bent.has_value());
    EXPECT_EQ(bent->clamps, (Array<std::uint32_t>{7, 6}));
    EXPECT_EQ(bent->ends, (std::array<std::uint32_t, 4>{3, 0, 1, 2}));
  }
  const auto part = detail::find_line_bends(tree, {{}, {}, {{{4, 0, 1, 2}}}, {}});
  ASSERT_TRUE(part.has_value());
  EXPECT_EQ((Joints{part->twist_begin, part->twist_end}), (Joints{1, 3}));
  EXPECT_TRUE(part->clamps.empty());
}

TEST(TwistedLines, AreNotFoundElsewhere) {
  const layouts::Tree tree = test::line_tree(4, 1);
  const auto found = [&](Array<detail::LoopBend> bends, const Array<Array<std::uint32_t>>& chains) {
    detail::LoopElements elements;
    elements.bends = std::move(bends);
    for (const auto& chain : chains) elements.twists.push_back({chain});
    return detail::find_line_bends(tree, elements).has_value();
  };
  EXPECT_TRUE(found({}, {{6, 4, 0, 1, 2, 3}}));
  EXPECT_FALSE(found({}, {{0, 1, 3}})) << "not in turn";
  EXPECT_FALSE(found({}, {{0, 1, 2, 0}})) << "a ring";
  EXPECT_FALSE(found({}, {{0, 1, 2}, {1, 2, 3}})) << "two of them";
  EXPECT_FALSE(found({}, {{2, 3, 5, 7}})) << "no anchor at the tip";
  EXPECT_FALSE(found({{{6, 4, 0}}}, {{8, 4, 0, 1}})) << "another clamp than the bend's";
}

/// Equal wires side by side, which differ in how they move and how far they are twisted. `ends` are clamped:
/// 1 is the root's and 2 the tip's. Twists leave out `left_out` particles at either end. Some rods give, and
/// the fourth breaks at `strength` (N).
Scene wires(std::uint32_t count, int ends, double strength, std::uint32_t left_out = 0) {
  constexpr std::uint32_t rods = 7;
  constexpr double l = 0.1;
  test::Random random(11);
  Scene scene;
  for (std::uint32_t w = 0; w < count; ++w) {
    const auto first = static_cast<std::uint32_t>(scene.particles.size());
    for (std::uint32_t i = 0; i < rods + 3; ++i) {
      const Vec3 at{l * (i - 1.0), 0.02 * (i % 2), 0.3 * w + 0.01 * (i % 3)};
      const bool is_fixed = ((ends & 1) != 0 && i <= 1) || ((ends & 2) != 0 && i >= rods + 1);
      scene.particles.push_back(is_fixed ? fixed(at) : movable(at, 0.02 * (1 + i % 3)));
      if (!is_fixed) scene.particles.back().velocity = random_vector(random, 0.3);
    }
    for (std::uint32_t i = 0; i < rods + 2; ++i) {
      if (scene.particles[first + i].fixed && scene.particles[first + i + 1].fixed) continue;
      Rod rod{.a = first + i, .b = first + i + 1, .mass = i % 2 == 0 ? 0.01 : 0};
      if (i % 3 == 2) rod.law = {.stiffness = 4e3};
      if (i == 3) rod.law.strength = strength;
      scene.rods.push_back(rod);
    }
    for (std::uint32_t i = 0; i < rods + 1; ++i)
      scene.bends.push_back({first + i, first + i + 1, first + i + 2, 0.05 * (1 + i % 2)});
    Twist& twist = scene.twists.emplace_back();
    for (std::uint32_t i = left_out; i < rods + 3 - left_out; ++i) twist.particles.push_back(first + i);
    twist.stiffness = 0.02;
    twist.angle = 2 + w;
  }
  return scene;
}

Settings direct(Gradient gradient, bool tensions = false) {
  return {.method = Method::direct, .gradient = gradient, .substeps = 4, .tensions = tensions, .threads = 1};
}

// A rod with a strength sends its island to the solver for any island, which has the same equations. Both
// solve them to rounding, 1e-8 of a rod in an iteration that converges by squares.
TEST(TwistedLines, MoveAsIslandsOfAnyShapeDo) {
  for (const Gradient gradient : {Gradient::mid, Gradient::new_})
    for (const int ends : {0, 1, 2, 3})
      for (const std::uint32_t left_out : {0, 2}) {
        SCOPED_TRACE(testing::Message() << to_string(gradient) << ' ' << ends << ' ' << left_out);
        const Scene start = wires(9, ends, never, left_out);
        World lines(start, direct(gradient, true));
        World islands(wires(9, ends, 1e30, left_out), direct(gradient, true));
        for (World* const world : {&lines, &islands})
          for (int i = 0; i < 30; ++i) {
            world->set_twist(1, 3 + 0.1 * i);
            if ((ends & 1) != 0 && gradient == Gradient::new_) world->move_anchor(0, {-0.1, 2e-3 * i, 0});
            const StepReport report = world->step(1.0 / 60);
            EXPECT_EQ(report.unsolved + report.fallbacks + report.elastic_substeps + report.halvings, 0u);
          }
        double apart = 0, moved = 0, turned = 0;
        for (std::uint32_t i = 0; i < lines.particle_count(); ++i) {
          apart = std::max(apart, norm(lines.position(i) - islands.position(i)));
          moved = std::max(moved, norm(lines.position(i) - start.particles[i].position));
          if (start.particles[i].fixed) {
            EXPECT_LE(norm(lines.reaction(i) - islands.reaction(i)), 1e-6 * (1 + norm(islands.reaction(i))))
                << i;
          }
        }
        for (std::uint32_t k = 0; k < 9; ++k) {
          EXPECT_NEAR(lines.twist(k), islands.twist(k), 1e-8) << k;
          turned = std::max(turned, std::abs(lines.twist(k) - start.twists[k].angle));
        }
        EXPECT_LE(apart, 1e-9);
        EXPECT_GT(moved, 1e-2);
        EXPECT_GT(turned, 1e-2);
        for (std::uint32_t i = 0; i < lines.rod_count(); ++i)
          EXPECT_NEAR(lines.tension(i), islands.tension(i), 1e-6 * (1 + std::abs(islands.tension(i)))) << i;
      }
}

// A twist that is given from the tip on is the same twist, but for the rounding of its length.
TEST(TwistedLines, HaveNoDirection) {
  Scene scene = wires(1, 3, never);
  World along(scene, direct(Gradient::mid));
  std::reverse(scene.twists[0].particles.begin(), scene.twists[0].particles.end());
  World back(scene, direct(Gradient::mid));
  test::run(along, 1.0 / 60, 20);
  test::run(back, 1.0 / 60, 20);
  EXPECT_LE(rms_distance(test::positions_of(along), test::positions_of(back)), 1e-11);
  EXPECT_NEAR(along.twist(0), back.twist(0), 1e-11);
  EXPECT_GT(std::abs(along.twist(0) - scene.twists[0].angle), 1e-3);
}

TEST(TwistedLines, HaveTheSameBitsInLanesAndAlone) {
  using Motion = std::pair<std::vector<Vec3>, double>;
  const auto motion = [&](std::uint32_t count, Isa isa) {
    World world(wires(count, 1, never), {.isa = isa, .threads = 1});
    test::run(world, 1.0 / 60, 20);
    Motion out{{}, world.twist(0)};
    for (std::uint32_t i = 0; i < 10; ++i) out.first.push_back(world.position(i));
    return out;
  };
  const Motion alone = motion(1, Isa::scalar);
  EXPECT_EQ(motion(1, best_isa()), alone);
  EXPECT_EQ(motion(20, best_isa()), alone);
  EXPECT_EQ(motion(20, Isa::scalar), alone);
}

double energy_of(const Scene& scene, const World& world) {
  double sum = test::energy_of(scene, world).total();
  for (std::uint32_t k = 0; k < scene.twists.size(); ++k) sum += twist_energy(scene, k, world.twist(k));
  return sum;
}

// Rounding of up to 1200 substeps, relative to what swings. Where wires are fast and steps long, Newton fails
// and substeps are halved elsewhere, which hands the twist over and back.
TEST(TwistedLines, GradientMidKeepsTheirEnergy) {
  for (const int ends : {0, 1, 3})
    for (const bool hard : {false, true}) {
      SCOPED_TRACE(testing::Message() << ends << (hard ? " hard" : ""));
      Scene scene = wires(9, ends, never);
      for (Rod& rod : scene.rods) rod.mass = 0;
      for (Particle& particle : scene.particles)
        if (hard) particle.velocity = 30 * particle.velocity;
      World world(scene, direct(Gradient::mid));
      const double start = energy_of(scene, world);
      StepReport report;
      double turned = 0;
      for (int i = 0; i < (hard ? 40 : 300); ++i) {
        report += world.step(hard ? 1.0 / 30 : 1.0 / 240);
        turned = std::max(turned, std::abs(world.twist(3) - scene.twists[3].angle));
        ASSERT_NEAR(energy_of(scene, world), start, 1e-11 * start) << i;
      }
      EXPECT_GE(turned, 0.05);
      EXPECT_EQ(report.halvings > 0, hard);
      EXPECT_EQ(report.fallbacks + report.unsolved, 0u);
    }
}

// A step that is repeated starts from the twist that it started from.
TEST(TwistedLines, KeepTheirEnergyWhereStepsAreRepeated) {
  Scene scene = wires(9, 1, never);
  for (Rod& rod : scene.rods) rod.mass = 0;
  for (const double accuracy : {1e-3, 1e-5}) {
    World world(scene,
                {.method = Method::direct, .gradient = Gradient::mid, .accuracy = accuracy, .threads = 1});
    const double start = energy_of(scene, world);
    StepReport report;
    for (int i = 0; i < 60; ++i) report += world.step(1.0 / 60);
    EXPECT_GT(report.repeated_steps, 0u);
    EXPECT_NEAR(energy_of(scene, world), start, 1e-11 * start);
  }
}

// No finite pull holds rigid rods that are drawn straight between anchors. They stay, and cost nothing.
TEST(TwistedLines, StayWhereTheyAreLocked) {
  for (const bool twisted : {false, true}) {
    constexpr std::uint32_t rods = 20;
    Scene scene;
    for (std::uint32_t i = 0; i < rods + 3; ++i) {
      const Vec3 at{0.05 * (i - 1.0), 0, 0};
      scene.particles.push_back(i < 2 || i > rods ? fixed(at) : movable(at, 0.05));
      if (i > 1 && i < rods + 2) scene.rods.push_back({.a = i - 1, .b = i});
      if (i > 1) scene.bends.push_back({i - 2, i - 1, i, 20});
    }
    for (std::uint32_t i = 2; i <= rods; ++i) scene.particles[i].velocity = {0, 0, 1e-6 * (i % 3)};
    if (twisted) {
      Twist& twist = scene.twists.emplace_back(Twist{.stiffness = 1, .angle = 12});
      for (std::uint32_t i = 0; i < rods + 3; ++i) twist.particles.push_back(i);
    }
    World world(scene, direct(Gradient::mid));
    const StepReport report = test::run(world, 1.0 / 60, 30);
    EXPECT_EQ(report.halvings + report.fallbacks + report.unsolved, 0u);
    for (std::uint32_t i = 0; i < rods + 3; ++i) EXPECT_EQ(world.position(i), scene.particles[i].position);
  }
}

}  // namespace
}  // namespace plumb::PLUMB_TEST_FILE
