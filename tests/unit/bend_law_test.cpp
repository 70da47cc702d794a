// The law of a bend: its energy, what gradient mid takes for its derivative, and the slopes that Newton
// needs.

#include "direct/bends/bend_law.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "direct/bends/island_rods.hpp"
#include "direct/bends/loop_bend.hpp"
#include "direct/bends/loop_bends.hpp"
#include "direct/loops/loop_state.hpp"
#include "plumb/plumb.hpp"
#include "scene/bends/bends.hpp"
#include "scene/bends/bent_islands.hpp"
#include "scene/bends/curvature.hpp"
#include "support/graphs.hpp"

namespace plumb::detail::PLUMB_TEST_FILE {
namespace {

constexpr BendFactors mid{0.5, 0.25, 0.5}, end_of_step{0.5, 0.25, 1};

Vec3 random_vector(test::Random& random, double size) {
  const double x = test::signed_unit(random), y = test::signed_unit(random), z = test::signed_unit(random);
  return size * Vec3{x, y, z};
}

BendNumbers bend(double rest, double damping) {
  return {{-1, 2, -1}, 3, rest, damping};
}

// 1 - q/4 = cos^2(phi/2) cancels near pi.
TEST(Curvature, IsTwiceTheTangentOfHalfTheAngle) {
  for (const double phi : {0.0, 1e-9, 0.1, 1.0, 2.0, 2.8}) {
    const double half = phi / 2, cosine = std::cos(half);
    EXPECT_NEAR(curvature_of_angle(phi), 2 * std::tan(half), 4e-16 * std::tan(half) / (cosine * cosine))
        << phi;
  }
}

// Where the rods fold, g goes on along its tangent.
TEST(Curvature, IsFiniteWhereRodsFold) {
  for (const double off : {-1e-9, 1e-9}) {
    EXPECT_NEAR(squared_curvature(folded + off), 252 + 4096 * off, 1e-9);
    EXPECT_NEAR(curvature_slope(folded + off), 4096, 1e-3);
  }
  EXPECT_TRUE(std::isfinite(curvature_of_angle(std::numbers::pi)));
}

// Rounding of an energy of up to 1e5 J. Some ends lie beyond where rods fold.
TEST(BendLaw, TheWorkOfGradientMidIsTheChangeOfEnergy) {
  test::Random random(1);
  for (int i = 0; i < 200; ++i) {
    const BendNumbers numbers = bend(i % 2 == 0 ? 0 : 0.7, 0);
    const Vec3 start = random_vector(random, 1.3), change = random_vector(random, i % 3 == 0 ? 1e-7 : 1.0);
    const Vec3 end = start + change;
    const auto energy = [&](Vec3 w) {
      return bending_energy(mid.kick * numbers.stiffness, numbers.curvature, dot(w, w));
    };
    const double gained = energy(end) - energy(start);
    EXPECT_NEAR(dot(bend_pull(numbers, mid, start, change).pull, change), gained,
                1e-13 * (energy(start) + energy(end)) + 1e-14);
  }
}

TEST(BendLaw, DampingTakesEnergyAndTurnsNothing) {
  test::Random random(2);
  for (int i = 0; i < 200; ++i) {
    BendNumbers numbers = bend(0, 2);
    numbers.stiffness = 0;
    const Vec3 start = random_vector(random, 0.5), change = random_vector(random, 0.5);
    const Vec3 pull = bend_pull(numbers, mid, start, change).pull;
    EXPECT_GE(dot(pull, change), 0);
    EXPECT_LE(norm(cross(pull, start + 0.5 * change)), 1e-14 * norm(pull));
  }
  // A bend that turns as a whole is not braked.
  BendNumbers numbers = bend(0, 2);
  numbers.stiffness = 0;
  EXPECT_LE(norm(bend_pull(numbers, mid, {0.3, 0, 0}, {-0.3, 0.3, 0}).pull), 1e-15);
}

// Against central differences of 1e-6 m, which are as exact as 1e-9 of the slopes.
TEST(BendLaw, SlopesAreDerivatives) {
  test::Random random(3);
  for (int i = 0; i < 60; ++i) {
    const BendNumbers numbers = bend(i % 2 == 0 ? 0 : 0.7, i % 3 == 0 ? 0 : 0.4);
    const BendFactors factors = i % 5 == 0 ? end_of_step : mid;
    const Vec3 start = random_vector(random, 0.6), change = random_vector(random, 0.6);
    const BendPull pull = bend_pull(numbers, factors, start, change);
    constexpr double h = 1e-6;
    const Vec3 axes[3] = {{h, 0, 0}, {0, h, 0}, {0, 0, h}};
    for (std::size_t c = 0; c < 3; ++c) {
      const Vec3 slope = 1 / (2 * h) *
                         (bend_pull(numbers, factors, start, change + axes[c]).pull -
                          bend_pull(numbers, factors, start, change - axes[c]).pull);
      const Vec3 found{pull.slope[c], pull.slope[3 + c], pull.slope[6 + c]};
      EXPECT_LE(norm(found - slope), 1e-6 * (1 + norm(slope))) << i;
    }
  }
}

// What is left out of it pushes from the straight line.
TEST(BendLaw, TheDefiniteSlopeIsNeverNegative) {
  test::Random random(4);
  for (int i = 0; i < 60; ++i) {
    const BendPull pull = definite_bend_pull(bend(1, 0), 1, random_vector(random, 1));
    for (int k = 0; k < 20; ++k) {
      const Vec3 v = random_vector(random, 1);
      const auto& s = pull.slope;
      const Vec3 product{s[0] * v.x + s[1] * v.y + s[2] * v.z, s[3] * v.x + s[4] * v.y + s[5] * v.z,
                         s[6] * v.x + s[7] * v.y + s[8] * v.z};
      EXPECT_GE(dot(product, v), -1e-12);
    }
  }
}

// A chain has a band as its matrix, so that its factors grow with the chain alone.
TEST(LoopSystem, ABentChainTakesLinearTime) {
  const auto operations = [](std::uint32_t nodes) {
    Array<LoopRod> rods{{0, nodes}};
    Array<LoopBend> bends{{{nodes + 1, nodes, 0}}, {{nodes, 0, 1}}};
    for (std::uint32_t i = 1; i < nodes; ++i) rods.push_back({i, i - 1});
    for (std::uint32_t i = 2; i < nodes; ++i) bends.push_back({{i - 2, i - 1, i}});
    return LoopSystem(rods, nodes, true, {bends, {}, {}}).analysis.operations() / nodes;
  };
  EXPECT_NEAR(operations(4000) / operations(40), 1, 0.15);
}

// Weights add up to nothing, so that a bend that moves as a whole does not feel it.
TEST(LoopBends, HaveWeightsOfTheirLengths) {
  Scene scene;
  scene.particles = {{.position = {0, 0, 0}, .fixed = true}, {.position = {2, 0, 0}, .mass = 1}};
  scene.particles.push_back({.position = {2, 4, 0}, .mass = 1});
  scene.rods = {{.a = 0, .b = 1}, {.a = 2, .b = 1}};
  scene.bends = {{.a = 0, .b = 1, .c = 2, .stiffness = 3, .damping = 5}};
  const auto topology = std::make_shared<LoopTopology>(2, 3, Array<LoopRod>{{1, 0}, {0, 2}});
  topology->bends = {{{2, 0, 1}}};
  LoopState state(topology);
  state.mass_unit = 2;
  load_bends(state, BendTable(scene), IslandRods(topology->rods), std::vector<std::uint32_t>{0});
  ASSERT_EQ(state.bends.size(), 1u);
  EXPECT_EQ(state.bends[0].law.weights, (std::array{-0.5, 0.75, -0.25}));
  EXPECT_EQ(state.bends[0].law.stiffness, 1.5);
  EXPECT_EQ(state.bends[0].law.damping, 2.5);
  EXPECT_EQ(state.bends[0].rods, (std::array{1u, 0u}));
}

// Both sides of an anchor that a bend joins are one island, which keeps its rods alone.
TEST(BentIslands, AreJoinedThroughAnAnchor) {
  Scene scene;
  for (int i = 0; i < 5; ++i)
    scene.particles.push_back({.position = {1.0 * i, 0, 0}, .mass = 1, .fixed = i == 2});
  for (std::uint32_t i = 0; i < 4; ++i) scene.rods.push_back({.a = i, .b = i + 1});
  const std::vector<layouts::Edge> edges{{0, 1}, {1, 2}, {2, 3}, {3, 4}};
  const std::vector<std::uint8_t> movable{1, 1, 0, 1, 1};
  const layouts::Graph graph{5, edges, movable};
  EXPECT_EQ(find_bent_islands(scene, graph).count(), 2u);
  EXPECT_FALSE(IslandElements(scene, find_bent_islands(scene, graph)).any_of(0));
  scene.bends = {{.a = 1, .b = 2, .c = 3, .stiffness = 1}};
  const layouts::Islands islands = find_bent_islands(scene, graph);
  ASSERT_EQ(islands.count(), 1u);
  EXPECT_EQ(islands.vertices(0).size(), 5u);
  EXPECT_EQ(islands.edges(0).size(), 4u);
  const IslandElements elements(scene, islands);
  const auto bends = elements.bends_of(0);
  EXPECT_EQ(std::vector(bends.begin(), bends.end()), (std::vector<std::uint32_t>{0}));
}

}  // namespace
}  // namespace plumb::detail::PLUMB_TEST_FILE
