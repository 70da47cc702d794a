// Rods that do not fit together: how they give way, and how they are brought to their lengths.

#include "direct/displacements/elastic_rods.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <memory>

#include "direct/attempts/elastic_tree.hpp"
#include "direct/displacements/displacement_newton.hpp"
#include "direct/loops/loop_newton.hpp"
#include "direct/loops/settle.hpp"
#include "plumb/layouts/trees.hpp"

namespace plumb::detail::PLUMB_TEST_FILE {
namespace {

/// A line of nodes along x between two fixed vertices, with rods of that length.
LoopState line(std::uint32_t nodes, double span, double length) {
  Array<LoopRod> rods;
  for (std::uint32_t i = 0; i <= nodes; ++i)
    rods.push_back(i == 0       ? LoopRod{0, nodes}
                   : i == nodes ? LoopRod{nodes - 1, nodes + 1}
                                : LoopRod{i, i - 1});
  auto topology = std::make_shared<LoopTopology>(nodes, nodes + 2, std::move(rods));
  topology->system = std::make_unique<LoopSystem>(topology->rods, nodes, true);
  LoopState state(topology);
  for (std::uint32_t i = 0; i < nodes; ++i) state.x[3 * i] = span * (i + 1) / (nodes + 1);
  state.x[3 * (nodes + 1)] = span;
  state.mass.assign(nodes, 1);
  state.length2.assign(nodes + 1, length * length);
  state.scale2 = length * length;
  return state;
}

double length_of(const LoopState& state, std::uint32_t rod) {
  const auto [a, b] = state.topology->rods[rod];
  return norm(state.position(a) - state.position(b));
}

// Three rods of 1 m over 3.3 m, the first node displaced: all give alike, but for what the mass of a node
// resists, some 1e-8 of its displacement.
TEST(ElasticRods, ShareWhatTheyLack) {
  LoopState state = line(2, 3.3, 1);
  state.x[0] = 0.9;
  LoopWorkspace work(state, Gradient::new_, Isa::scalar);
  Tally tally;
  LoopStepper(Gradient::new_, 0).advance_elastic(state, 0.01, work, tally);
  EXPECT_EQ(tally.elastic_substeps, 1u);
  EXPECT_EQ(tally.unsolved, 0u);
  for (std::uint32_t k = 0; k < 3; ++k) EXPECT_NEAR(length_of(state, k), 1.1, 1e-6) << k;
}

// Rods that fit move as rigid ones do, but for their compliance of 1e-8, which adds up in 20 substeps.
TEST(ElasticRods, DoWhatRigidOnesDoWhereThoseFit) {
  LoopState state = line(4, 4.5, 1);
  LoopWorkspace work(state, Gradient::new_, Isa::scalar);
  ASSERT_TRUE(settle(state, work));
  for (std::uint32_t i = 0; i < 4; ++i) state.force[3 * i + 1] = -9.81;
  LoopState rigid = state;
  Tally tally;
  const LoopStepper stepper(Gradient::new_, 0);
  for (int i = 0; i < 20; ++i) {
    stepper.advance_elastic(state, 0.01, work, tally);
    ASSERT_TRUE(stepper.try_substep(rigid, 0.01, work, tally));
  }
  for (std::size_t i = 0; i < state.x.size(); ++i) EXPECT_NEAR(state.x[i], rigid.x[i], 1e-6);
}

// Without multipliers in its matrix Newton's method finds what it finds with them, to rounding.
TEST(DisplacementNewton, FindsWhatMultipliersFind) {
  LoopState state = line(4, 4.5, 1);
  LoopWorkspace work(state, Gradient::new_, Isa::scalar);
  ASSERT_TRUE(settle(state, work));
  const double h = 0.01;
  for (std::uint32_t i = 0; i < 4; ++i) state.force[3 * i + 1] = -9.81;
  LoopState other = state;
  Tally tally;
  ASSERT_TRUE(LoopStepper(Gradient::new_, 0).try_substep(state, h, work, tally));
  for (std::uint32_t i = 0; i < 12; ++i) work.load[i] = h * h / 2 * other.force[i];
  std::fill(work.delta.begin(), work.delta.end(), 0.0);
  std::fill(other.mu.begin(), other.mu.end(), 0.0);
  measure_rods(other, work);
  DisplacementFactor factor(*other.topology, Isa::scalar);
  ASSERT_TRUE(iterate_by_displacements(other, 1, factor, work, tally));
  for (std::uint32_t i = 0; i < 12; ++i) EXPECT_NEAR(other.x[i] + work.delta[i], state.x[i], 1e-12) << i;
}

TEST(ElasticRods, AreNotMovedByWhatIsNotFinite) {
  LoopState state = line(2, 3.3, 1);
  state.force[0] = std::numeric_limits<double>::infinity();
  const Array<double> before = state.x;
  LoopWorkspace work(state, Gradient::new_, Isa::scalar);
  Tally tally;
  LoopStepper(Gradient::new_, 0).advance_elastic(state, 0.01, work, tally);
  EXPECT_EQ(tally.unsolved, 1u);
  EXPECT_EQ(state.x, before);
}

TEST(Settle, FindsABowForAStraightLine) {
  LoopState state = line(9, 9, 1);
  LoopWorkspace work(state, Gradient::new_, Isa::scalar);
  ASSERT_TRUE(settle(state, work));
  for (std::uint32_t k = 0; k < 10; ++k) EXPECT_NEAR(length_of(state, k), 1, 1e-12) << k;
  // One bow, symmetric, and along -y where there is no gravity.
  for (std::uint32_t i = 0; i < 9; ++i) {
    EXPECT_LT(state.position(i).y, -0.1) << i;
    EXPECT_NEAR(state.position(i).y, state.position(8 - i).y, 1e-9) << i;
  }
}

// What cannot fit shares what it lacks, and rests.
TEST(Settle, SharesWhatCannotFit) {
  LoopState state = line(2, 3.3, 1);
  state.x[0] = 0.9;
  LoopWorkspace work(state, Gradient::new_, Isa::scalar);
  EXPECT_FALSE(settle(state, work));
  for (std::uint32_t k = 0; k < 3; ++k) EXPECT_NEAR(length_of(state, k), 1.1, 1e-6) << k;
  for (const double u : state.u) EXPECT_EQ(u, 0);
}

// Rods so short that no bow has a finite misfit leave particles where they are.
TEST(Settle, KeepsWhatItCannotMeasure) {
  LoopState state = line(9, 9, 1);
  state.length2.assign(10, 1e-310);
  const std::size_t numbers = state.x.size();
  LoopWorkspace work(state, Gradient::new_, Isa::scalar);
  EXPECT_FALSE(settle(state, work));
  EXPECT_EQ(state.x.size(), numbers);
  for (const double x : state.x) EXPECT_TRUE(std::isfinite(x));
}

// Its rods share what they lack, but for the sag under gravity.
TEST(ElasticTree, SharesWhatItLacks) {
  Scene scene;
  for (std::uint32_t i = 0; i < 4; ++i)
    scene.particles.push_back({.position = {1.1 * i, 0.01 * i, 0}, .mass = 1.0 + i, .fixed = i % 3 == 0});
  for (std::uint32_t i = 0; i < 3; ++i) scene.rods.push_back({.a = i, .b = i + 1, .length = 1});
  const std::uint32_t vertices[] = {0, 1, 2, 3}, edges[] = {0, 1, 2};
  const layouts::Edge graph_edges[] = {{0, 1}, {1, 2}, {2, 3}};
  const std::uint8_t movable[] = {0, 1, 1, 0};
  const auto tree = layouts::find_tree({.vertices = 4, .edges = graph_edges, .movable = movable});
  ASSERT_TRUE(tree);
  const auto topology = std::make_shared<const TreeTopology>(*tree);
  TreeState<double> state(topology, 1);
  state.fill_lane(0, scene, MassModel::lumped, *tree, {vertices, edges});
  ElasticTree<double> elastic(topology, Gradient::mid, 0, Isa::scalar);
  Tally tally;
  for (int i = 0; i < 50; ++i) elastic.advance(state, 1.0 / 60, tally);
  EXPECT_EQ(tally.unsolved, 0u);
  double least = 2, most = 0;
  const auto see = [&](Vec3 a, Vec3 b) {
    least = std::min(least, norm(a - b));
    most = std::max(most, norm(a - b));
  };
  const std::uint32_t of_first = tree->vertex[0] == 1 ? 0 : 1;
  see(state.position(of_first, 0), scene.particles[0].position);
  see(state.position(0, 0), state.position(1, 0));
  see(state.position(1 - of_first, 0), scene.particles[3].position);
  EXPECT_NEAR(most, least, 1e-5);
  EXPECT_NEAR(most, 1.1, 1e-3);
}

}  // namespace
}  // namespace plumb::detail::PLUMB_TEST_FILE
