// The equation of a rod that gives, as trees and loops take it, and the bookkeeping around it: numbers of
// laws, lengths on the way, and problems by their counts.

#include <gtest/gtest.h>

#include <cmath>
#include <vector>

#include "contact/lengths/rod_lengths.hpp"
#include "direct/laws/held_rods.hpp"
#include "direct/laws/law_factors.hpp"
#include "direct/laws/loop_laws.hpp"
#include "direct/laws/pulls_ahead.hpp"
#include "direct/laws/tree_laws.hpp"
#include "direct/laws/tree_rods.hpp"
#include "interface/changes.hpp"
#include "interface/problems.hpp"
#include "plumb/report.hpp"
#include "scenes/generators/generators.hpp"
#include "step/inputs/lengths.hpp"
#include "support/tree_numbers.hpp"
#include "time/verlet.hpp"

// The equation of a rod needs the functions of one lane.
#include "simd/tree/one_lane.hpp"

// It is included here.
#include "simd/tree/law_math.hpp"

namespace plumb::detail::PLUMB_TEST_FILE {
namespace {

constexpr double h = 0.01;

TEST(PulledTime, IsFromMiddleToMiddleWithGradientOld) {
  EXPECT_EQ(pulled_time(0, h, 0), h / 2) << "from a velocity on";
  EXPECT_EQ(pulled_time(0, h, 2 * h), 1.5 * h);
  EXPECT_EQ(pulled_time(0.5, h, 0), h);
  EXPECT_EQ(pulled_time(1, h, 2 * h), h);
}

TEST(LawFactors, ShareAKickBetweenSubsteps) {
  const LawFactors first = LawFactors::of(Gradient::old, h * h / 2, 0, h, 0);
  EXPECT_EQ(first.kick_back, 0) << "nothing comes before";
  EXPECT_EQ(first.kick_before, 0);
  const LawFactors next = LawFactors::of(Gradient::old, h * h, h, h, 0);
  EXPECT_NEAR(next.kick_back, h * h / 2, 1e-18);
  EXPECT_NEAR(next.kick_before * (0.5 * h), next.kick_back, 1e-18) << "a half kick weighs as much";
  EXPECT_EQ(LawFactors::of(Gradient::mid, 1, h, h, 0).share, 0.5);
  EXPECT_EQ(LawFactors::of(Gradient::new_, 1, h, h, 0).share, 1);
}

TEST(LawNumbers, AreRelativeToTheUnitOfMass) {
  const auto elastic = law_numbers({.stiffness = 8, .damping = 2, .strength = 40}, {2, 0.5});
  EXPECT_EQ(elastic, (std::array<double, 6>{4, 1, 0, 0, 4, 20}));
  const auto cable = law_numbers({.one_sided = true}, {2, 0.5});
  EXPECT_EQ(cable, (std::array<double, 6>{0, 0, 1, 1, 0, 0}));
}

TEST(RateChanges, AreAllButRounding) {
  EXPECT_TRUE(rate_changes(0, 1e-3));
  EXPECT_TRUE(rate_changes(1, 0));
  EXPECT_TRUE(rate_changes(1, 1.2));
  EXPECT_FALSE(rate_changes(0, 0));
  EXPECT_FALSE(rate_changes(1, 1 + 1e-9));
}

// What a rod of gradient mid does over a substep is the change of its energy, slack or taut at either end.
TEST(CablePull, IsTheChangeOfEnergyOverThatOfLength) {
  constexpr double stiffness = 7;
  const auto energy = [&](double c) { return c > 0 ? 0.5 * stiffness * c * c : 0; };
  for (const double before : {-0.2, -0.01, 0.0, 0.03, 0.3})
    for (const double after : {-0.25, -0.02, 0.01, 0.2, 0.3}) {
      const double half = stiffness / 2, taut = std::max(before, 0.0);
      const simd::LawStart<double> start{1, half * (before + taut), before, 0};
      const auto pull = simd::cable_pull(half, start, after, true);
      EXPECT_NEAR(pull.psi * (after - before), energy(after) - energy(before), 1e-15) << before << after;
      const double step = 1e-7;
      const double slope = (simd::cable_pull(half, start, after + step, true).psi -
                            simd::cable_pull(half, start, after - step, true).psi) /
                           (2 * step);
      EXPECT_NEAR(pull.slope, slope, 1e-6) << before << ' ' << after;
    }
}

LoopLaws one_rod(const RodLaw& law) {
  LoopLaws laws;
  laws.make(std::vector<double>{1.0});
  laws.rods[0] = law_numbers(law, {1, 1});
  return laws;
}

// A row is Newton's: after a step along it the rod's equation holds to second order of the step.
TEST(LoopLaws, RowsAreNewtons) {
  const LoopLaws laws = one_rod({.stiffness = 500, .damping = 1});
  for (const Gradient gradient : {Gradient::mid, Gradient::old, Gradient::new_}) {
    LawWorkspace work;
    work.factors = LawFactors::of(gradient, h * h / 2, 0, h, 0);
    work.is_mid = gradient == Gradient::mid;
    work.starts.resize(1);
    const double theta = theta_of(gradient), start = 1.1;
    start_law(laws, 0, start * start, (start * start - 1) / 2, work);
    double end = start, mu = 0;
    for (int i = 0; i < 6; ++i) {
      const RodRow row = law_row(laws, work, 0, {end * end - start * start, (end * end - 1) / 2, mu}, theta);
      // Let a force -mu pull the end against a spring of 1: end - start = mu (start + theta (end - start)).
      const double along = start + theta * (end - start);
      // Unknown changes x of end and n of mu: use end x + soft n = -c, x - along n - theta mu x = rest.
      const double rest = mu * along - (end - start);
      const double n = (-row.c * (1 - theta * mu) - row.use * end * rest) /
                       (row.soft * (1 - theta * mu) + row.use * end * along);
      end += (rest + along * n) / (1 - theta * mu);
      mu += n;
    }
    const double share = gradient == Gradient::new_ ? 1 : 0.5, kick = h * h / 2;
    const double psi = 500 * (share * (end - 1) + (1 - share) * (start - 1)) + 1 / h * (end - start);
    EXPECT_NEAR(mu * (start + theta * (end - start)) + kick * psi, 0, 1e-14) << to_string(gradient);
    EXPECT_NEAR(pulled_length(work.starts[0], mu, theta), start + theta * (end - start), 1e-12);
  }
}

TEST(LoopLaws, BreakAboveTheirStrength) {
  LoopLaws laws = one_rod({.stiffness = 500, .strength = 10});
  LawWorkspace work;
  work.factors = LawFactors::of(Gradient::new_, 1, 0, h, 0);
  work.starts.resize(1);
  start_law(laws, 0, 1, 0, work);
  std::vector<double> length2{1};
  EXPECT_EQ(end_rods(laws, work, {h, 0, 1, 2, h}, std::vector<double>{-9.0}, length2), 0u);
  EXPECT_NEAR(laws.impulse[0], h * 9 * 2, 1e-15) << "a pull of 9 units of 2 kg for a substep";
  EXPECT_EQ(end_rods(laws, work, {h, 0, 1, 2, h}, std::vector<double>{-11.0}, length2), 1u);
  EXPECT_EQ(laws.rods[0], LoopLaws::Numbers{});
  start_law(laws, 0, 1, 0, work);
  const RodRow row = law_row(laws, work, 0, {0, 0, -3}, 1);
  EXPECT_EQ(row.use, 0);
  EXPECT_EQ(row.c, -3 * row.soft) << "what it pulled goes";
  EXPECT_GT(row.soft, 0);
}

TEST(TreeRods, TakeTheLengthOfASubstepsEndOrMiddle) {
  Scene scene = scenes::make_chain(3);
  scene.rods[2].law.stiffness = 100;
  test::TreeNumbers<double> n(scene, 1);
  ASSERT_TRUE(n.state.laws.gives);
  n.state.laws.moves = true;
  n.state.laws.rate.rods[1] = n.state.laws.rate.rods[2] = 1;
  set_substep_lengths(n.state, h);
  EXPECT_NEAR(std::sqrt(n.state.length2[1]), 0.1 + h, 1e-15);
  EXPECT_NEAR(std::sqrt(n.state.length2[2]), 0.1 + h / 2, 1e-15);
  n.view();
  EXPECT_EQ(end_rods(n.state, h, 0.5, n.work), 0u);
  EXPECT_NEAR(std::sqrt(n.state.length2[2]), 0.1 + h, 1e-15);
  TreeLaws<double> copy;
  copy.copy_flags(n.state.laws);
  EXPECT_TRUE(copy.moves);
}

TEST(HeldRods, AreHeldAlongWhereTheyPulled) {
  test::TreeNumbers<double> n(scenes::make_chain(2), 1);
  n.state.laws.pulls = true;
  n.state.hold.assign(1, {});
  n.state.tie_mu[0] = -3;
  const double unit = n.state.mass_unit[0], kick = n.work.kick[0];
  for (std::uint32_t c = 0; c < 3; ++c) {
    n.work.tie_rod[c] = c == 0 ? 0.1 : 0;  // the rod leads from the anchor along x
    n.work.delta[c] = c == 1 ? 0.02 : 0;   // and its end goes along y
    n.state.tie_delta[c] = 0;
  }
  hold_rods(n.state, h, 0.5, n.work);
  EXPECT_LE(norm(n.state.hold[0] - (-3 * h / kick * unit) * Vec3{0.1, 0.01, 0}), 1e-12);
  n.state.hold[0] = {};
  n.work.tie_blow[0] = 2;
  hold_rod_blows(n.state, n.work);
  EXPECT_LE(norm(n.state.hold[0] - 2 * unit * Vec3{0.1, 0, 0}), 1e-15);
}

TEST(Lengths, GoStraightAndStop) {
  Lengths lengths(scenes::make_chain(2));
  double length = 0, rate = 0;
  const auto tell = [&](std::uint32_t rod, double new_length, double new_rate) {
    EXPECT_EQ(rod, 1u);
    length = new_length, rate = new_rate;
  };
  lengths.set_target(1, 0.3);
  lengths.begin_step(0.5, tell);
  EXPECT_EQ(length, 0.1);
  EXPECT_NEAR(rate, 0.4, 1e-15);
  lengths.end_step(tell);
  EXPECT_EQ(lengths.length(1), 0.3);
  EXPECT_EQ(length, 0.3);
  EXPECT_NEAR(rate, 0.4, 1e-15) << "velocities at the end of the step have it";
  ASSERT_EQ(lengths.moving().size(), 1u);
  lengths.begin_step(0.5, tell);
  EXPECT_EQ(rate, 0);
  lengths.end_step(tell);
  EXPECT_TRUE(lengths.moving().empty());
}

// A rod of 2 m that is hauled in by 1 m/s from 1.5 m, and pulls with 4 N s in the first half second.
TEST(RodLengths, FollowTheirRates) {
  RodLengths lengths;
  EXPECT_TRUE(lengths.squares().empty());
  EXPECT_EQ(lengths.square(1), 1);
  lengths.set(1, 2, 2, 1.5, -1);
  EXPECT_TRUE(lengths.move());
  EXPECT_TRUE(lengths.jump());
  EXPECT_EQ(lengths.speed(), 1);
  EXPECT_EQ(lengths.square(0), 1);
  EXPECT_NEAR(lengths.square(1), 0.75 * 0.75, 1e-15);
  lengths.follow(0.5);
  EXPECT_NEAR(lengths.square(1), 0.25, 1e-15);
  EXPECT_NEAR(lengths.changes()[0].half_square_rate, -0.25, 1e-15) << "L L' over the square of 2 m";
  lengths.follow_last();
  EXPECT_EQ(lengths.changes()[0].half_square_rate, 0) << "it stood before";
  lengths.begin_step();
  lengths.begin_pulls(std::vector<double>{7, 1});
  lengths.end_pulls(std::vector<double>{8, 5});
  EXPECT_EQ(lengths.changes()[0].work, 2) << "at the mean of both rates";
  lengths.end_substep();
  EXPECT_FALSE(lengths.jump());
  lengths.set(1, 2, 2, 1, 0);
  EXPECT_FALSE(lengths.move());
  EXPECT_TRUE(lengths.jump());
}

TEST(Problems, AreWhatCountsSay) {
  StepReport before, after;
  before.unsolved = after.unsolved = 4;
  EXPECT_EQ(troubles_between(before, after), 0);
  ++after.unsolved;
  ++after.elastic_substeps;
  ++after.capped_steps;
  Array<Problem> found;
  append_problems(troubles_between(before, after), 7, found);
  ASSERT_EQ(found.size(), 3u);
  EXPECT_EQ(to_string(found[0].kind), "unsolved");
  EXPECT_EQ(to_string(found[1].kind), "elastic");
  EXPECT_EQ(to_string(found[2].kind), "capped");
  EXPECT_EQ(found[2].particle, 7u);
}

TEST(RodJudge, LeavesOutWhatMayBeOffItsLength) {
  Scene scene = scenes::make_chain(4);
  scene.rods[1].law.stiffness = 10;
  scene.rods[2].law.one_sided = true;
  const RodJudge judge(scene);
  Array<Problem> found;
  const auto squeezed = [&](std::uint32_t i) { return 0.5 * scene.particles[i].position; };
  const auto strain = [](std::uint32_t, double distance) { return distance / 0.1 - 1; };
  judge.judge(
      0.01, squeezed, strain, [](std::uint32_t rod) { return rod == 3; }, found);
  ASSERT_EQ(found.size(), 1u) << "elastic, slack and broken rods are left out";
  EXPECT_EQ(found[0].rod, 0u);
  EXPECT_EQ(found[0].particle, 1u);
  EXPECT_NEAR(found[0].strain, -0.5, 1e-12);
}

}  // namespace
}  // namespace plumb::detail::PLUMB_TEST_FILE
