// The thesis's other methods below their solvers: integrators, multipliers against Featherstone's method, and
// the matrices of an implicit step.

#include <gtest/gtest.h>

#include <Eigen/Core>
#include <cmath>
#include <numeric>

#include "reference/featherstone/featherstone.hpp"
#include "reference/mechanical_system.hpp"
#include "reference/multipliers/multipliers.hpp"
#include "reference/multipliers/rod_equations.hpp"
#include "reference/springs/implicit_euler.hpp"
#include "scenes/generators/generators.hpp"
#include "support/random_trees.hpp"
#include "support/worlds.hpp"

namespace plumb::detail::PLUMB_TEST_FILE {
namespace {

/// x'' = -x from x = 1 at rest: x = cos t.
class Oscillator final : public MechanicalSystem {
 public:
  explicit Oscillator(Integrator integrator) : MechanicalSystem(integrator) {}
  MechanicalState initial_state(const Drive&) const override {
    return {Eigen::VectorXd::Ones(1), Eigen::VectorXd::Zero(1)};
  }
  void accelerations(const MechanicalState& state, const Drive&, double, Eigen::VectorXd& out) override {
    out = -state.q;
  }
  Vec3 position(const MechanicalState& state, std::uint32_t) const override { return {state.q[0], 0, 0}; }
  Vec3 velocity(const MechanicalState& state, std::uint32_t) const override { return {state.v[0], 0, 0}; }
};

double error_after_a_second(Integrator integrator, int steps) {
  Oscillator system(integrator);
  MechanicalState state = system.initial_state({});
  for (int i = 0; i < steps; ++i) system.advance(state, {}, 1.0 / steps);
  return std::abs(system.position(state, 0).x - std::cos(1.0));
}

// Halving the step divides the error by 2 to the order, to a tenth of the order.
TEST(MechanicalSystem, IntegratorsHaveTheirOrders) {
  for (const auto& [integrator, order] :
       {std::pair{Integrator::explicit_euler, 1.0}, std::pair{Integrator::semi_implicit_euler, 1.0},
        std::pair{Integrator::rk2, 2.0}, std::pair{Integrator::rk4, 4.0}}) {
    const double ratio = error_after_a_second(integrator, 64) / error_after_a_second(integrator, 128);
    EXPECT_NEAR(std::log2(ratio), order, 0.1 * order) << to_string(integrator);
  }
  EXPECT_THROW(error_after_a_second(Integrator::implicit_euler, 1), std::logic_error);
}

Drive drive_of(const Scene& scene) {
  Drive drive;
  drive.forces.resize(scene.particles.size());
  drive.anchor_velocities.resize(scene.particles.size());
  for (const Particle& particle : scene.particles) drive.anchors.push_back(particle.position);
  return drive;
}

TEST(Drive, AnchorsGoStraight) {
  const Drive drive{.forces = {}, .anchors = {{1, 2, 3}}, .anchor_velocities = {{0, 2, -4}}};
  EXPECT_EQ(drive.anchor(0, 0.5), (Vec3{1, 3, 1}));
}

// Particles under multipliers and turning links are two ways to write one mechanical system: after 0.1 s at
// steps of 1 ms of rk4 they are at the same places, to the error of both.
TEST(MechanicalSystem, MultipliersAndFeatherstoneAgree) {
  const Scene scene = scenes::make_chain(5, 0.1, 10);
  std::vector<std::uint32_t> particles(scene.particles.size()), rods(scene.rods.size());
  std::iota(particles.begin(), particles.end(), 0u);
  std::iota(rods.begin(), rods.end(), 0u);
  Settings settings{.method = Method::multipliers};
  settings.integrator = Integrator::rk4;
  const auto by_multipliers = make_multipliers(scene, settings);
  settings.method = Method::featherstone;
  const auto by_turning = make_featherstone(scene, settings, {particles, rods});
  const Drive drive = drive_of(scene);
  MechanicalState one = by_multipliers->initial_state(drive), other = by_turning->initial_state(drive);
  EXPECT_NE(one.q.size(), other.q.size());
  for (int i = 0; i < 100; ++i) {
    by_multipliers->advance(one, drive, 1e-3);
    by_turning->advance(other, drive, 1e-3);
  }
  by_multipliers->place(one, drive);
  by_turning->place(other, drive);
  for (std::uint32_t i = 1; i < scene.particles.size(); ++i) {
    EXPECT_LE(norm(by_multipliers->position(one, i) - by_turning->position(other, i)), 1e-8) << i;
    EXPECT_LE(norm(by_multipliers->velocity(one, i) - by_turning->velocity(other, i)), 1e-6) << i;
  }
  EXPECT_GT(norm(by_turning->velocity(other, 5)), 0.5) << "it moves";
  one.q[0] = INFINITY;
  EXPECT_FALSE(one.finite());
}

// M x - Jᵀ lambda = f and J x = c: of a tree, and of a ring, where the last rod closes it. J x is compared
// with c; what M x leaves of f must be along the rods, so a motion that pulls on none sees none of it.
TEST(RodEquations, SolutionsMeetTheirConstraints) {
  Scene ring;
  for (int i = 0; i < 6; ++i)
    ring.particles.push_back(
        test::movable({std::cos(i * std::acos(0.5)), std::sin(i * std::acos(0.5)), 0.1 * (i % 2)}, 1 + i));
  for (std::uint32_t i = 0; i < 6; ++i) ring.rods.push_back({.a = i, .b = (i + 1) % 6});
  test::Random random(51);
  for (const Scene& scene : {scenes::make_chain(7), ring}) {
    RodSolver solver(scene, MassModel::lumped);
    const RodEquations& equations = solver.equations();
    EXPECT_EQ(equations.tree.has_value(), &scene != &ring && scene.rods.size() == 7);
    ASSERT_EQ(equations.rows.size(), scene.rods.size());
    for (Eigen::Index i = 0; i < solver.f.size(); ++i) solver.f[i] = test::signed_unit(random);
    for (std::size_t r = 0; r < equations.rows.size(); ++r) {
      const Rod& rod = scene.rods[equations.rows[r].rod];
      const Vec3 apart = scene.particles[rod.a].position - scene.particles[rod.b].position;
      const bool turned = equations.particle[equations.rows[r].a] != rod.a;
      solver.directions[r] = (turned ? -1.0 : 1.0) * apart;
      solver.c[static_cast<Eigen::Index>(r)] = test::signed_unit(random);
    }
    const Eigen::VectorXd& x = solver.solve();
    for (std::size_t r = 0; r < equations.rows.size(); ++r) {
      const auto& row = equations.rows[r];
      Vec3 across{x[3 * row.a], x[3 * row.a + 1], x[3 * row.a + 2]};
      if (row.b != RodEquations::none) across -= {x[3 * row.b], x[3 * row.b + 1], x[3 * row.b + 2]};
      EXPECT_NEAR(dot(solver.directions[r], across), solver.c[static_cast<Eigen::Index>(r)], 1e-12);
    }
  }
}

// A matrix in blocks is what was added to it, and one with a negative pivot is refused or solved all the
// same, never wrongly.
TEST(BlockMatrix, SolvesWhatWasAdded) {
  BlockMatrix matrix;
  const std::pair<std::uint32_t, std::uint32_t> pairs[] = {{1, 0}, {2, 1}, {2, 1}};
  matrix.set_pattern(3, 3, pairs);
  Eigen::MatrixXd dense = Eigen::VectorXd::LinSpaced(9, 3, 5).asDiagonal();
  matrix.set_diagonal(dense.diagonal());
  test::Random random(52);
  for (const auto& [row, column] : {pairs[0], pairs[1]}) {
    Eigen::Matrix3d part;
    for (int i = 0; i < 9; ++i) part(i / 3, i % 3) = 0.5 * test::signed_unit(random);
    matrix.add(matrix.find(row, column), 0, 0, part);
    dense.block<3, 3>(3 * row, 3 * column) += part;
    dense.block<3, 3>(3 * column, 3 * row) += part.transpose();
  }
  const Eigen::VectorXd right = Eigen::VectorXd::LinSpaced(9, -1, 1);
  Eigen::VectorXd x;
  ASSERT_TRUE(matrix.solve(right, x));
  EXPECT_LE((dense * x - right).norm(), 1e-14);
  matrix.set_diagonal(Eigen::VectorXd::Zero(9));
  EXPECT_FALSE(matrix.solve(right, x)) << "a matrix of zeros";
}

TEST(ImplicitEuler, CrossMatricesAreCrossProducts) {
  EXPECT_EQ(to_vec3(cross_matrix(to_eigen({1, 2, 3})) * to_eigen({-2, 0, 5})), cross({1, 2, 3}, {-2, 0, 5}));
}

}  // namespace
}  // namespace plumb::detail::PLUMB_TEST_FILE
