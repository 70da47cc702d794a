// How trees are stepped directly: lines in segments, first guesses, limits of Newton's method, and a substep.

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <memory>

#include "direct/laws/tree_rods.hpp"
#include "direct/trees/line_segments.hpp"
#include "direct/trees/newton_guess.hpp"
#include "direct/trees/newton_limits.hpp"
#include "direct/trees/tree_kind.hpp"
#include "direct/trees/tree_stepper.hpp"
#include "scenes/generators/generators.hpp"
#include "support/islands.hpp"
#include "support/worlds.hpp"

namespace plumb::detail::PLUMB_TEST_FILE {
namespace {

using Kind = TreeKind<double>;

/// One tree of a scene, in lane 0 of one.
TreeState<double> state_of(const Scene& scene, const test::IslandsOf& of,
                           const std::shared_ptr<const TreeTopology>& topology) {
  TreeState<double> state(topology, 1);
  state.fill_lane(0, scene, MassModel::consistent, of.tree(0), {of.islands.vertices(0), of.islands.edges(0)});
  return state;
}

Kind kind_of(const layouts::Tree& tree, Kind::Rules rules) {
  return Kind(tree, 1, rules);
}
constexpr Kind::Rules old_rules{Gradient::old, 2, false, false, false, 0, Isa::scalar, 1};

/// Largest |length - L| / L of the rods of a line whose node 0 hangs from its only tie.
double largest_strain(const TreeState<double>& state) {
  double largest = 0;
  for (std::uint32_t i = 0; i < state.topology->nodes; ++i) {
    const Vec3 above =
        i > 0 ? state.position(i - 1, 0) : Vec3{state.tie_x[0], state.tie_x[1], state.tie_x[2]};
    const double length = std::sqrt(i > 0 ? state.length2[i] : state.tie_length2[0]);
    largest = std::max(largest, std::abs(norm(state.position(i, 0) - above) / length - 1));
  }
  return largest;
}

// Rods keep their lengths to what Newton leaves, with every gradient, and a pendulum that starts level falls.
TEST(TreeStepper, KeepsLengths) {
  const Scene scene = scenes::make_chain(10);
  const test::IslandsOf of(scene);
  for (const Gradient gradient : {Gradient::old, Gradient::mid, Gradient::new_}) {
    Kind::Rules rules = old_rules;
    rules.gradient = gradient;
    Kind kind = kind_of(of.tree(0), rules);
    TreeState<double> state = state_of(scene, of, kind.topology);
    Tally report;
    const double before = state.position(9, 0).y;
    for (int i = 0; i < 30; ++i) kind.stepper.advance(state, 0.01, kind.crews[0].view(), report);
    EXPECT_LE(largest_strain(state), 1e-9) << to_string(gradient);
    EXPECT_LT(state.position(9, 0).y, before - 0.01) << to_string(gradient);
    EXPECT_EQ(report.unsolved, 0u);
  }
}

// One part of a step is stable at any tension up to a frequency; twice the substep, at least as many pieces.
TEST(TreeStepper, CutsLongSubstepsOfStiffTrees) {
  const Scene scene = scenes::make_chain(10, 0.1, 1000);
  const test::IslandsOf of(scene);
  Kind kind = kind_of(of.tree(0), old_rules);
  TreeState<double> state = state_of(scene, of, kind.topology);
  EXPECT_EQ(kind.stepper.cuts(state, 0.1), 1u) << "no tension is known yet";
  Tally report;
  for (int i = 0; i < 100; ++i) kind.stepper.advance(state, 1e-3, kind.crews[0].view(), report);
  const std::uint32_t cuts = kind.stepper.cuts(state, 0.1);
  EXPECT_GT(cuts, 1u);
  EXPECT_GE(kind.stepper.cuts(state, 0.2), cuts);
  // No piece is above the frequency that is aimed at.
  EXPECT_LE(0.1 / cuts * std::sqrt(state.frequency2), tree_limits::aimed_frequency * 1.0001);
}

// A substep that has failed leaves multipliers that need not be finite.
TEST(TreeStepper, CountsNoPullsOfLanesThatFailed) {
  const test::IslandsOf of(scenes::make_chain(3));
  Kind kind = kind_of(of.tree(0), old_rules);
  TreeState<double> state = state_of(scenes::make_chain(3), of, kind.topology);
  state.laws.make(state.mu.size(), state.tie_mu.size(), 1);
  state.laws.pulls = true;
  auto& work = kind.crews[0].work;
  work.kick[0] = 1e-4;
  state.mu[1] = state.tie_mu[0] = std::numeric_limits<double>::quiet_NaN();
  for (const double active : {0.0, 1.0}) {
    work.active[0] = active;
    end_rods(state, 0.01, 0, work);
    EXPECT_EQ(std::isnan(state.laws.impulse.rods[1]), active != 0);
    EXPECT_EQ(std::isnan(state.laws.impulse.ties[0]), active != 0);
  }
}

TEST(TreeKind, KnowsWhatItsSubstepsEstimate) {
  const test::IslandsOf of(scenes::make_chain(4));
  Kind::Rules rules = old_rules;
  EXPECT_FALSE(kind_of(of.tree(0), rules).estimates()) << "no accuracy";
  rules.controlled = true;
  EXPECT_TRUE(kind_of(of.tree(0), rules).estimates());
  rules.time_order = 4;
  EXPECT_FALSE(kind_of(of.tree(0), rules).estimates());
  rules.time_order = 2;
  rules.gradient = Gradient::new_;
  EXPECT_FALSE(kind_of(of.tree(0), rules).estimates());
  rules.threads = 3;
  rules.changes_gradient = true;
  const Kind kind = kind_of(of.tree(0), rules);
  EXPECT_EQ(kind.crews.size(), 3u);
  EXPECT_TRUE(kind.calm_stepper.has_value());
}

// More trees than are remembered come and come again, and all are as layouts::find_tree() finds them.
TEST(TreeKinds, RememberTreesAsTheyAreFound) {
  TreeKinds kinds;
  for (int turn = 0; turn < 2; ++turn)
    for (std::uint32_t rods = 1; rods < 100; ++rods) {
      const test::IslandsOf of(scenes::make_chain(rods));
      const layouts::LocalGraph island = of.local(0);
      const auto tree = kinds.tree_of(island);
      EXPECT_EQ(kinds.tree_of(island), tree) << rods;
      const layouts::Tree found = of.tree(0);
      EXPECT_EQ(tree->vertex, found.vertex) << rods;
      EXPECT_EQ(tree->parent, found.parent) << rods;
      EXPECT_EQ(tree->edge, found.edge) << rods;
      EXPECT_EQ(tree->tie_begin, found.tie_begin) << rods;
      EXPECT_EQ(tree->ties.size(), found.ties.size()) << rods;
    }
  const Array<layouts::Edge> ring{{0, 1}, {1, 2}, {2, 0}};
  for (int turn = 0; turn < 2; ++turn) EXPECT_EQ(kinds.tree_of({ring, {1, 1, 1}}), nullptr);
}

// Nodes go to lanes in order, all but the last full, and what is cut and gathered again is the line.
TEST(LineSegments, CutAndGatherIsTheLine) {
  const std::uint32_t lanes = layouts::lane_width<double>, nodes = 45;
  const Scene scene = scenes::make_chain(nodes);
  const test::IslandsOf of(scene);
  const auto topology = std::make_shared<const TreeTopology>(of.tree(0));
  EXPECT_TRUE(LineSegments::fits(*topology, lanes));
  const test::IslandsOf branched(scenes::make_tree());
  EXPECT_FALSE(LineSegments::fits(TreeTopology(branched.tree(0)), lanes));
  const LineSegments segments(nodes, lanes);
  for (std::uint32_t i = 0; i < nodes; ++i) {
    EXPECT_EQ(segments.lane(i) * segments.length() + segments.entry(i), i);
    EXPECT_EQ(segments.begins(i), segments.entry(i) == 0);
    EXPECT_LT(segments.lane(i), lanes);
  }
  TreeState<double> whole = state_of(scene, of, topology), back = state_of(scene, of, topology);
  for (std::size_t i = 0; i < whole.x.size(); ++i) whole.x[i] = 1.0 + static_cast<double>(i);
  for (std::size_t i = 0; i < whole.mu.size(); ++i) whole.mu[i] = 0.5 * static_cast<double>(i);
  whole.mu[0] = 0;  // node 0 has a tie, and no rod to a parent
  TreeState<double> cut = segments.cut(whole);
  segments.gather(cut, back);
  for (std::size_t i = 0; i < whole.x.size(); ++i) EXPECT_EQ(back.x[i], whole.x[i]) << i;
  for (std::size_t i = 1; i < whole.mu.size(); ++i) EXPECT_EQ(back.mu[i], whole.mu[i]) << i;
  // The first rod of a lane begins where the lane before ends.
  segments.link(cut);
  for (std::uint32_t lane = 1; segments.length() * lane < nodes; ++lane)
    EXPECT_EQ(cut.tie_x[lane], whole.x[3 * (segments.length() * lane - 1)]);
}

// Tensions mu/kick that change evenly in time are extrapolated exactly; without a past nothing is guessed.
TEST(NewtonGuess, ExtrapolatesEvenChanges) {
  const test::IslandsOf of(scenes::make_chain(2));
  TreeState<double> state(std::make_shared<const TreeTopology>(of.tree(0)), 1);
  using tree_limits::multiplier_scales;
  EXPECT_EQ(multiplier_scales(state, 0, 1e-4, Gradient::old), (std::pair{0.0, 0.0}));
  const auto tension = [](double t) { return 3 + 5 * t; };
  const double before = 0.01, step = 0.015, kick = 2e-4;
  state.mu_kick_before[0] = 1e-4;
  state.mu_kick[0] = 1.5e-4;
  state.u_step_before[0] = before;
  state.u_step[0] = step;
  const auto [scale, scale_before] = multiplier_scales(state, 0, kick, Gradient::old);
  const double mu_before = tension(0) * 1e-4, mu = tension(before) * 1.5e-4;
  EXPECT_NEAR(scale * mu + scale_before * mu_before, tension(before + step) * kick, 1e-18);
  const auto [scale_mid, before_mid] = multiplier_scales(state, 0, kick, Gradient::mid);
  EXPECT_NEAR(scale_mid * mu, tension(before) * kick, 1e-18) << "mid's are carried on";
  EXPECT_EQ(before_mid, 0);
}

// Whether a solve has converged does not depend on the size of the scene, and what is not a number is
// hopeless.
TEST(NewtonLimits, AreRelativeToRods) {
  using namespace tree_limits;
  for (const double scale2 : {1e-6, 1.0, 1e6}) {
    for (const Gradient gradient : {Gradient::old, Gradient::mid}) {
      const double change2 = square(converged_change<double>(gradient)) * scale2;
      const double residual2 = square(solved_residual<double> * scale2);
      EXPECT_TRUE(has_converged<double>(0.99 * change2, 0.99 * residual2, scale2, gradient));
      EXPECT_FALSE(has_converged<double>(1.01 * change2, 0, scale2, gradient));
      EXPECT_FALSE(has_converged<double>(0, 1.01 * residual2, scale2, gradient));
    }
    EXPECT_FALSE(is_hopeless(0.99 * square(hopeless_change) * scale2, scale2));
    EXPECT_TRUE(is_hopeless(1.01 * square(hopeless_change) * scale2, scale2));
    EXPECT_TRUE(is_hopeless(std::numeric_limits<double>::quiet_NaN(), scale2));
  }
  EXPECT_LT(converged_change<double>(Gradient::mid), converged_change<float>(Gradient::mid));
  EXPECT_LT(aimed_frequency, highest_frequency);
  EXPECT_LT(highest_frequency, 2) << "where gradient old breaks";
}

}  // namespace
}  // namespace plumb::detail::PLUMB_TEST_FILE
