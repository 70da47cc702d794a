// The bodies of the loops of trees, for one lane: a substep's stages against what they are to leave.

#include <gtest/gtest.h>

// Every body is made of those before it.
// clang-format off
#include "simd/tree/one_lane.hpp"
#include "simd/tree/tree_lanes.hpp"
#include "simd/tree/law_lanes.hpp"
#include "simd/inline.hpp"
#include "simd/tree/lines/bent_lanes.hpp"
#include "simd/tree/motion_lanes.hpp"
#include "simd/tree/lines/line_lanes.hpp"
#include "simd/tree/lines/segment_lanes.hpp"
// clang-format on

#include "direct/laws/law_factors.hpp"
#include "scenes/generators/generators.hpp"
#include "support/tree_numbers.hpp"

namespace plumb::simd::PLUMB_TEST_FILE {
namespace {

using Numbers = test::TreeNumbers<double>;

/// |x + delta - that of the parent or tie|² - L² of a line's rod i.
double left_of(const Numbers& n, std::uint32_t i) {
  double sum = 0;
  for (std::uint32_t c = 0; c < 3; ++c) {
    const double above =
        i > 0 ? n.state.x[3 * (i - 1) + c] + n.work.delta[3 * (i - 1) + c] : n.state.tie_x[c];
    const double d = n.state.x[3 * i + c] + n.work.delta[3 * i + c] - above;
    sum += d * d;
  }
  return sum - (i > 0 ? n.state.length2[i] : n.state.tie_length2[0]);
}

// prepare_lanes(): load = M u + kick force, and rods from where particles are.
TEST(MotionBody, PreparesLoadsAndRods) {
  Numbers n(scenes::make_chain(6), 1);
  prepare_lanes<double, 1>(n.view(), 0);
  for (std::uint32_t i = 0; i < 6; ++i)
    for (std::uint32_t c = 0; c < 3; ++c) {
      const double mass = n.state.node[tree_fields::node * i];
      EXPECT_NEAR(n.work.load[3 * i + c],
                  mass * n.work.ratio[0] * n.state.u[3 * i + c] + n.work.kick[0] * n.state.force[3 * i + c],
                  1e-15);
      if (i > 0) {
        EXPECT_EQ(n.work.rod[tree_fields::rod * i + c], n.state.x[3 * i + c] - n.state.x[3 * i - 3 + c]);
      }
    }
  EXPECT_NEAR(n.work.rod[tree_fields::rod + 3], 0, 1e-15) << "rods begin at their lengths";
}

// Newton on the whole tree and on multipliers alone are the same iteration on a line (theta 0): after some
// steps rods have their lengths and both have the same displacements, to rounding.
TEST(TreeBody, NewtonOfTreesAndOfLinesAgree) {
  Numbers tree(scenes::make_chain(12, 0.1, 10), 1), line(scenes::make_chain(12, 0.1, 10), 1);
  prepare_lanes<double, 1>(tree.view(), 0);
  prepare_lanes<double, 1>(line.view(), 0);
  ASSERT_TRUE(tree.view().is_plain);
  for (int i = 0; i < 8; ++i) {
    newton_lanes<Laws::none, double, 1>(tree.view(), 0, 0.0);
    newton_line_lanes<Laws::none, double, 1>(line.view(), 0);
  }
  double moved = 0;
  for (std::uint32_t i = 0; i < 12; ++i) {
    EXPECT_NEAR(left_of(tree, i), 0, 1e-14);
    EXPECT_NEAR(left_of(line, i), 0, 1e-14);
    for (std::uint32_t c = 0; c < 3; ++c) {
      EXPECT_NEAR(tree.work.delta[3 * i + c], line.work.delta[3 * i + c], 1e-13);
      moved = std::max(moved, std::abs(line.work.delta[3 * i + c]));
    }
  }
  EXPECT_GT(moved, 1e-4);
  EXPECT_LE(tree.work.change[0], 1e-28) << "the last change, squared";
}

// Rods that give obey mu l0 + kick k (c0 + c1)/2 = 0 with gradient old, to rounding, however the row is made:
// along a tree, along a line, and along a line that knows of cables, of which none is one.
TEST(TreeBody, ElasticRowsOfTreesLinesAndCablesAgree) {
  constexpr double stiffness = 2000, h = 0.01;
  Scene scene = scenes::make_chain(12, 0.1, 10);
  for (Rod& rod : scene.rods) rod.law.stiffness = stiffness;
  const auto begin = [&](Numbers& n, bool is_line, bool cables) {
    n.work.is_line = is_line;
    n.state.laws.cables = cables;
    n.state.laws.set_factors(0, detail::LawFactors::of(Gradient::old, n.work.kick[0], 0, h, 0));
    prepare_lanes<double, 1>(n.view(), 0);
  };
  Numbers tree(scene, 1), line(scene, 1), cables(scene, 1);
  begin(tree, false, false);
  begin(line, true, false);
  begin(cables, true, true);
  for (int i = 0; i < 8; ++i) {
    newton_lanes<Laws::two_sided, double, 1>(tree.view(), 0, 0.0);
    newton_line_lanes<Laws::two_sided, double, 1>(line.view(), 0);
    newton_line_lanes<Laws::cables, double, 1>(cables.view(), 0);
  }
  double most = 0;
  for (std::uint32_t i = 0; i < 12; ++i) {
    for (std::uint32_t c = 0; c < 3; ++c) {
      EXPECT_NEAR(tree.work.delta[3 * i + c], line.work.delta[3 * i + c], 1e-13);
      EXPECT_NEAR(cables.work.delta[3 * i + c], line.work.delta[3 * i + c], 1e-13);
    }
    const double length2 = i > 0 ? line.state.length2[i] : line.state.tie_length2[0],
                 length = std::sqrt(length2);
    const double after = std::sqrt(left_of(line, i) + length2),
                 mu = i > 0 ? line.state.mu[i] : line.state.tie_mu[0];
    const double pull = line.work.kick[0] * stiffness / line.state.mass_unit[0] * (after - length) / 2;
    EXPECT_NEAR(mu * length + pull, 0, 1e-14) << "it starts at its length";
    most = std::max(most, std::abs(pull));
  }
  EXPECT_GT(most, 1e-5) << "rods pull";
}

// advance_lanes(): x moves by delta, and only of active lanes.
TEST(MotionBody, AdvancesActiveLanes) {
  Numbers n(scenes::make_chain(3), 1);
  prepare_lanes<double, 1>(n.view(), 0);
  for (std::size_t i = 0; i < n.work.delta.size(); ++i) n.work.delta[i] = 0.5 * static_cast<double>(i);
  const double before = n.state.x[4];
  advance_lanes<double, 1>(n.view(), 0);
  EXPECT_EQ(n.state.x[4], before + 2);
  EXPECT_EQ(n.state.u[4], 2) << "u_delta is 1, u_before 0";
  n.work.active[0] = 0;
  advance_lanes<double, 1>(n.view(), 0);
  EXPECT_EQ(n.state.x[4], before + 2);
}

// Twice the sum of |mu| at a node over its mass, where that is largest.
TEST(MotionBody, BoundsTheStiffnessByHand) {
  Numbers n(scenes::make_chain(3), 1);
  n.state.tie_mu[0] = -1;
  n.state.mu[1] = -4;
  n.state.mu[2] = 3;
  find_stiffness_lanes<double, 1>(n.view(), 0);
  EXPECT_NEAR(n.work.stiffness[0], 2 * (4 + 3) * n.state.node[tree_fields::node * 1 + 3], 1e-14);
}

// A vector shifted by one lane: zero comes in at both ends.
TEST(SegmentBody, NeighborsAreOneLaneAway) {
  constexpr std::size_t lanes = logical_width<double>;
  Neighbors<double> of;
  for (std::size_t lane = 0; lane < lanes; ++lane) of.put(lane, 1.0 + static_cast<double>(lane));
  for (std::size_t lane = 0; lane < lanes; ++lane) {
    EXPECT_EQ(of.own<double>(lane), 1.0 + static_cast<double>(lane));
    EXPECT_EQ(of.from_before<double>(lane), static_cast<double>(lane));
    EXPECT_EQ(of.from_after<double>(lane), lane + 1 < lanes ? 2.0 + static_cast<double>(lane) : 0.0);
  }
}

}  // namespace
}  // namespace plumb::simd::PLUMB_TEST_FILE
