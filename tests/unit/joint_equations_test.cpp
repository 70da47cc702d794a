// What methods multipliers and featherstone are made of where islands have bodies and joints.

#include "reference/multipliers/joint_equations.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "plumb/error.hpp"
#include "plumb/joints.hpp"
#include "reference/featherstone/body_tree.hpp"
#include "reference/multipliers/joint_forces.hpp"
#include "reference/multipliers/past_folds.hpp"
#include "reference/multipliers/refinement.hpp"
#include "reference/multipliers/small_matrices.hpp"
#include "reference/multipliers/weighted_sum.hpp"
#include "support/bodies.hpp"

namespace plumb::detail::PLUMB_TEST_FILE {
namespace {

/// Two bodies in the air on a hinge, which a spring, a torsion and a drive work on.
Scene hinged() {
  Scene scene;
  MassProperties box = solid_box(2, {0.1, 0.2, 0.3});
  const std::uint32_t one = add_body(scene, box);
  box.center = {0.3, 0.1, 0};
  const std::uint32_t other = add_body(scene, box);
  add_revolute(scene, one, other, {0.15, 0, 0}, {0.2, 0, 1});
  const Point hinge = point_on_body(scene, one, {0.15, 0, 0});
  scene.springs.push_back({.a = point_at(0),
                           .b = point_on_body(scene, other, {0.4, 0, 0.1}),
                           .length = 0.1,
                           .stiffness = 50,
                           .damping = 2,
                           .force = 1});
  scene.torsions.push_back({.axis = {hinge, point_on_body(scene, one, {0.35, 0, 1})},
                            .u = {hinge, point_on_body(scene, one, {0, 0.5, 0})},
                            .v = {hinge, point_on_body(scene, other, {0.7, 0.3, 0})},
                            .angle = 2,
                            .stiffness = 5,
                            .damping = 0.3,
                            .torque = 0.7});
  scene.angles.push_back(
      {.u = scene.torsions[0].u, .v = scene.torsions[0].v, .target = 1, .stiffness = 3, .damping = 0.1});
  return scene;
}

std::vector<Vec3> places(const Scene& scene) {
  std::vector<Vec3> out;
  for (const Particle& particle : scene.particles) out.push_back(particle.position);
  return out;
}
/// Velocities that no symmetry helps.
std::vector<Vec3> any_velocities(std::size_t count) {
  std::vector<Vec3> out;
  for (std::size_t i = 0; i < count; ++i) {
    const auto k = static_cast<double>(i);
    out.push_back({std::sin(k), std::cos(2 * k), std::sin(3 * k + 1)});
  }
  return out;
}

TEST(WeightedSum, IsTheWayBetweenPlaces) {
  const WeightedSum sum = way(Point{{0, 1}, {0.5, 0.5}}, Point{{1, 2}, {0.25, 0.75}});
  const std::vector<Vec3> x{{1, 0, 0}, {0, 2, 0}, {0, 0, 4}};
  EXPECT_EQ(sum.terms.size(), 3u);
  EXPECT_EQ(sum.of(x), (Vec3{-0.5, -0.5, 3}));
}

// What acts between bodies pushes nothing as a whole and turns nothing as a whole.
TEST(JointForces, KeepMomentumAndAngularMomentum) {
  const Scene scene = hinged();
  const std::vector<Vec3> x = places(scene), v = any_velocities(x.size());
  const auto n = static_cast<std::uint32_t>(x.size());
  Eigen::VectorXd f = Eigen::VectorXd::Zero(3 * n);
  JointForces(scene, n).add(x, v, f);
  Vec3 force{}, moment{};
  for (std::uint32_t i = 0; i < n; ++i) {
    force += load3(&f[3 * i]);
    moment += cross(x[i], load3(&f[3 * i]));
  }
  EXPECT_GT(f.norm(), 1);
  EXPECT_LE(norm(force), 1e-13 * f.norm());
  EXPECT_LE(norm(moment), 1e-13 * f.norm());
}

// Constraints are quadratic, so that central differences are their rates to rounding, and second differences
// are their bends.
TEST(JointEquations, HaveTheDerivativesOfTheirConstraints) {
  const Scene scene = hinged();
  const JointEquations equations(scene, MassModel::consistent);
  const std::vector<Vec3> x = places(scene), v = any_velocities(x.size());
  const auto at = [&](double t) {
    std::vector<Vec3> moved = x;
    for (std::size_t i = 0; i < x.size(); ++i) moved[i] += t * v[i];
    Eigen::VectorXd out(equations.rows());
    equations.violations(moved, out);
    return out;
  };
  Eigen::VectorXd rates = Eigen::VectorXd::Zero(equations.rows()), bends = rates;
  equations.add_rates(x, v, 1, rates);
  equations.add_bends(v, 1, bends);
  EXPECT_LE((0.5 * (at(1) - at(-1)) - rates).norm(), 1e-13 * rates.norm());
  EXPECT_LE((at(1) - 2 * at(0) + at(-1) - bends).norm(), 1e-13 * bends.norm());
}

// A hinge that is there twice changes no acceleration.
TEST(JointEquations, AreSolvedWhereConstraintsAreRedundant) {
  const Scene once = hinged();
  Scene twice = once;
  twice.pins.push_back(once.pins[0]);
  twice.alignments.push_back(once.alignments[0]);
  const std::vector<Vec3> x = places(once), v = any_velocities(x.size());
  const auto solved = [&](const Scene& scene) {
    JointEquations equations(scene, MassModel::consistent);
    equations.f.setZero();
    equations.add_momenta(v, 1, equations.f);
    equations.c.setZero();
    Eigen::VectorXd out = equations.solve();
    EXPECT_LE(equations.take_largest_miss(), 1e-14);
    return out;
  };
  const Eigen::VectorXd expected = solved(once);
  EXPECT_LE((solved(twice) - expected).norm(), 1e-11 * expected.norm());
}

TEST(Refinement, StopsAtWhatIsEnoughOrDoesNotHalve) {
  Eigen::VectorXd x = Eigen::VectorXd::Zero(8), lambda = x;
  Refinement refinement;
  const auto rounds = [&](double share) {
    int count = 0;
    double left = 1;
    refinement.run(
        x, lambda, 1.5e-3, [&] { return left; }, [&] { left *= share, ++count; });
    return count;
  };
  EXPECT_EQ(rounds(0.1), 3);
  EXPECT_EQ(rounds(0.9), 1);
}

// A substep that misses is taken in two parts, and each of those again, until none does. Together they are as
// long, and anchors go on between them.
TEST(PastFolds, TakeUnequalPartsWhereAStepMisses) {
  PastFolds folds;
  MechanicalState state;
  state.q = Eigen::VectorXd::Zero(8);
  state.v = state.q;
  const Drive drive{{}, {Vec3{}}, {Vec3{1, 0, 0}}};
  std::vector<double> taken;
  double miss = 0;
  folds.step(
      state, drive, 1,
      [&](MechanicalState& of, const Drive& by, double h) {
        miss = h > 0.5 ? 1 : 0;
        EXPECT_NEAR(of.q[0], by.anchors[0].x, 1e-15);
        of.q[0] += h;
        if (miss == 0) taken.push_back(h);
      },
      [&] { return std::exchange(miss, 0.0); });
  ASSERT_EQ(taken.size(), 3u);
  EXPECT_NE(taken[1], taken[2]);
  EXPECT_NEAR(state.q[0], 1, 1e-15);
}

TEST(BodyTree, HangsBodiesFromWhatCarriesThem) {
  const BodyTree free = find_body_tree(hinged(), 0);
  ASSERT_EQ(free.hung.size(), 2u);
  EXPECT_FALSE(free.hangs);
  EXPECT_TRUE(free.hung[0].floats);
  EXPECT_EQ(free.hung[1].parent, 0u);
  EXPECT_TRUE(free.hung[1].is_hinge);
  EXPECT_LE(norm(free.hung[1].joint - Vec3{0.15, 0, 0}), 1e-15);
  Scene loose = hinged();
  loose.particles.push_back(test::movable({1, 1, 1}, 1));
  EXPECT_THROW(find_body_tree(loose, 0), InputError);
}

}  // namespace
}  // namespace plumb::detail::PLUMB_TEST_FILE
