// The law of a twist against cross sections that are carried along, and its slopes against differences.

#include "direct/twists/twist_law.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "direct/twists/loop_twist.hpp"
#include "direct/twists/loop_twists.hpp"
#include "scene/bends/bent_islands.hpp"
#include "scene/bends/rod_table.hpp"
#include "scene/bends/twists.hpp"

namespace plumb::detail::PLUMB_TEST_FILE {
namespace {

Vec3 unit(Vec3 v) {
  return 1 / norm(v) * v;
}

/// Carries a cross section by the shortest turn that takes one vector to the other.
Vec3 carried(Vec3 section, Vec3 from, Vec3 to) {
  const Vec3 axis = cross(unit(from), unit(to)), turned = cross(axis, section);
  return section + turned + 1 / (1 + dot(unit(from), unit(to))) * cross(axis, turned);
}

RodPair moved(const RodPair& rods, double share, const RodPair& by) {
  return {rods.first + share * by.first, rods.second + share * by.second};
}

constexpr RodPair bent{{1, 0.2, 0.1}, {0.7, 0.5, -0.4}};

// The error of a step is of third order, so that of many is of second.
TEST(TwistLaw, IsTheTurnOfCrossSectionsThatAreCarriedAlong) {
  const auto error = [](double size) {
    const RodPair by{size * Vec3{0.3, -0.2, 0.5}, size * Vec3{-0.1, 0.6, 0.4}}, end = moved(bent, 1, by);
    const Vec3 first = unit(cross(bent.first, {0, 0, 1}));
    const Vec3 second = carried(first, bent.first, bent.second);
    const Vec3 present = carried(second, bent.second, end.second);
    const Vec3 untwisted = carried(carried(first, bent.first, end.first), end.first, end.second);
    const double twist =
        std::atan2(dot(cross(untwisted, present), unit(end.second)), dot(untwisted, present));
    const RodPair direction = twist_direction(moved(bent, 0.5, by));
    return std::abs(twist - dot(direction.first, by.first) - dot(direction.second, by.second));
  };
  EXPECT_LE(error(0.1), 1e-4);
  EXPECT_NEAR(std::log10(error(0.1) / error(0.01)), 3, 0.1);
}

TEST(TwistLaw, HasTheTorqueOfItsTangents) {
  const RodPair direction = twist_direction(bent);
  const Vec3 torque = cross(bent.first, direction.first) + cross(bent.second, direction.second);
  EXPECT_LE(norm(torque - (unit(bent.first) - unit(bent.second))), 1e-15);
}

TEST(TwistLaw, HasTheSlopesOfItsDirection) {
  const RodPair folded{{1, 0.2, 0.1}, {-1, -0.3, -0.1}};
  for (const RodPair& rods : {bent, folded}) {
    const TwistSlopes slopes = twist_slopes(rods);
    const double step = 1e-6;
    for (std::size_t s = 0; s < 2; ++s)
      for (std::size_t j = 0; j < 3; ++j) {
        const Vec3 axis{j == 0 ? 1.0 : 0, j == 1 ? 1.0 : 0, j == 2 ? 1.0 : 0};
        const RodPair by = s == 0 ? RodPair{axis, {}} : RodPair{{}, axis};
        const RodPair after = twist_direction(moved(rods, step, by));
        const RodPair before = twist_direction(moved(rods, -step, by));
        const Vec3 found[2] = {1 / (2 * step) * (after.first - before.first),
                               1 / (2 * step) * (after.second - before.second)};
        for (std::size_t r = 0; r < 2; ++r) {
          const auto& of = slopes.of[r][s];
          EXPECT_LE(norm(found[r] - Vec3{of[j], of[3 + j], of[6 + j]}), 1e-7);
        }
      }
  }
}

TEST(TwistLaw, AChainHasAJointWhereItsRodsMeet) {
  const LoopTwist open{{4, 2, 7, 1}}, ring{{4, 2, 7, 4}};
  EXPECT_EQ(open.joints(), 2u);
  EXPECT_EQ(ring.joints(), 3u);
  EXPECT_EQ(open.joint(1), (std::array<std::uint32_t, 3>{2, 7, 1}));
  EXPECT_EQ(ring.joint(2), (std::array<std::uint32_t, 3>{7, 4, 2}));
}

// A chain goes on through an anchor, and its clamp has no length.
TEST(TwistLaw, JoinsWhatHangsFromBothSidesOfAnAnchor) {
  Scene scene;
  const auto add = [&](double x, bool fixed) {
    scene.particles.push_back({.position = {x, 0, 0}, .mass = 1, .fixed = fixed});
  };
  for (const double x : {0.0, 1.0, 2.0, 3.0}) add(x, x == 0 || x == 2);
  add(-1, true);
  scene.rods = {{.a = 0, .b = 1}, {.a = 1, .b = 2}, {.a = 2, .b = 3}};
  scene.twists = {{.particles = {4, 0, 1, 2, 3}, .stiffness = 1}};
  EXPECT_EQ(twist_length(scene, RodTable(scene), scene.twists[0]), 3);
  const std::vector<layouts::Edge> edges{{0, 1}, {1, 2}, {2, 3}};
  const std::vector<std::uint8_t> movable{0, 1, 0, 1, 0};
  const layouts::Islands islands = find_bent_islands(scene, {5, edges, movable});
  ASSERT_EQ(islands.count(), 1u);
  const IslandElements elements(scene, islands);
  const auto twists = elements.twists_of(0);
  EXPECT_EQ(std::vector(twists.begin(), twists.end()), (std::vector<std::uint32_t>{0}));
  EXPECT_TRUE(elements.bends_of(0).empty() && elements.tackles_of(0).empty());
}

}  // namespace
}  // namespace plumb::detail::PLUMB_TEST_FILE
