// The linear algebra of truths against the same equations written out and solved densely.
#include <gtest/gtest.h>

#include <string>

#include "scenes/generators/generators.hpp"
#include "support/dense_constraints.hpp"
#include "support/truths.hpp"
#include "truth/constraint_solver.hpp"

namespace plumb::truth::PLUMB_TEST_FILE {
namespace {

/// Numbers in [-1, 1) that look random and are the same everywhere.
class Numbers {
 public:
  Real next() {
    state_ = state_ * 6364136223846793005u + 1442695040888963407u;
    return static_cast<Real>(state_ >> 40) / (1 << 23) - 1;
  }

 private:
  std::uint64_t state_ = 1;
};

struct Difference {
  Real acceleration = 0;  ///< largest, relative to the largest acceleration
  Real length = 0;        ///< largest error of a rod's equation, likewise
  std::size_t redundant = 0;
  std::size_t rows = 0;
};

/// Solves for forces at random and for rods that move with accelerations at random, so that redundant rods
/// agree.
Difference against_dense(const Scene& scene, MassModel mass) {
  const Model model = make_model(scene, mass);
  const State state = start_of(scene, model);
  const test::DenseConstraints dense(scene, mass);
  Numbers numbers;
  std::vector<Point> f(model.particles()), wish(model.particles()), a(model.particles());
  std::vector<Real> c(model.rods.size()), mu(model.rods.size());
  for (std::size_t i = 0; i < f.size(); ++i) {
    f[i] = {numbers.next(), numbers.next(), numbers.next()};
    if (!model.fixed[i]) wish[i] = {numbers.next(), numbers.next(), numbers.next()};
  }
  test::DenseConstraints::Vector right = test::DenseConstraints::Vector::Zero(dense.matrix().rows());
  for (std::size_t r = 0; r < c.size(); ++r) {
    const ModelRod& rod = model.rods[r];
    if (rod.elastic) continue;
    c[r] = dot(state.x[rod.b] - state.x[rod.a], wish[rod.b] - wish[rod.a]);
    right(dense.unknowns() + static_cast<Eigen::Index>(r)) = c[r];
  }
  for (std::size_t i = 0; i < f.size(); ++i) {
    if (dense.row(i) >= 0) right.segment<3>(dense.row(i)) << f[i].x, f[i].y, f[i].z;
  }
  const auto expected = dense.solve(right);

  ConstraintSolver solver(model);
  solver.factor(state.x);
  solver.solve(f, c, a, mu);
  Difference out{.redundant = solver.redundant(), .rows = solver.rows()};
  Real largest = 0;
  for (std::size_t i = 0; i < f.size(); ++i) {
    if (dense.row(i) < 0) {
      EXPECT_EQ(norm(a[i]), 0) << "fixed particle " << i;
      continue;
    }
    const Eigen::Index k = dense.row(i);
    const Point other{expected(k), expected(k + 1), expected(k + 2)};
    largest = std::max(largest, norm(other));
    out.acceleration = std::max(out.acceleration, norm(a[i] - other));
  }
  for (std::size_t r = 0; r < c.size(); ++r) {
    const ModelRod& rod = model.rods[r];
    if (rod.elastic) {
      EXPECT_EQ(mu[r], 0) << "elastic rod " << r;
      continue;
    }
    out.length =
        std::max(out.length, std::abs(dot(state.x[rod.b] - state.x[rod.a], a[rod.b] - a[rod.a]) - c[r]));
  }
  out.acceleration /= largest;
  out.length /= largest;
  return out;
}

/// Rounding of long double, 1e-19, times what the systems' condition numbers, up to 1e3, make of it; the
/// masses of the dense one are rounded to double, 1e-16.
constexpr Real rounding = 1e-15L;

void expect_same(const Scene& scene, std::size_t rows, std::size_t redundant,
                 MassModel mass = MassModel::consistent) {
  const Difference difference = against_dense(scene, mass);
  EXPECT_LT(difference.acceleration, rounding);
  EXPECT_LT(difference.length, rounding);
  EXPECT_EQ(difference.rows, rows);
  EXPECT_EQ(difference.redundant, redundant);
}

TEST(TruthSolver, EliminatesChains) {
  expect_same(scenes::make_chain(20, 0.1, 1000), 0, 0);
  expect_same(scenes::make_rods5(), 0, 0);
  expect_same(scenes::make_rods5(), 0, 0, MassModel::lumped);
}

TEST(TruthSolver, EliminatesBranches) {
  expect_same(scenes::make_tree(), 0, 0);
  expect_same(scenes::make_tree(), 0, 0, MassModel::lumped);
}

TEST(TruthSolver, EliminatesWhatFloats) {
  Scene scene = scenes::make_tree();
  scene.particles[0] = test::loose({0, 0, 0}, 0.3);
  expect_same(scene, 0, 0);
}

TEST(TruthSolver, TakesCentresAndInertiasOfRods) {
  Scene scene = scenes::make_tree();
  scene.rods[1].center = 0.2;
  scene.rods[2].inertia = 0.01;
  scene.rods[5].center = 0.9;
  scene.rods[5].inertia = 0.1;
  expect_same(scene, 0, 0);
  expect_same(scene, 0, 0, MassModel::lumped);
}

TEST(TruthSolver, HangsOnSeveralFixedParticles) {
  Scene scene = scenes::make_tree();
  scene.particles.push_back(test::anchor({1, 1, 1}));
  scene.particles.push_back(test::anchor({0.5, 1, -1}));
  scene.rods.push_back({.a = 7, .b = 5, .mass = 1});
  scene.rods.push_back({.a = 3, .b = 8});
  scene.rods.push_back({.a = 8, .b = 5});
  expect_same(scene, 3, 0);
}

TEST(TruthSolver, ClosesLoops) {
  expect_same(test::hung_ring(0), 2, 0);
  // The closing rod of a ring of rods with mass is welded in by three equations; the second way to the ground
  // is one.
  expect_same(test::hung_ring(1), 4, 0);
  expect_same(test::hung_ring(1), 2, 0, MassModel::lumped);
}

TEST(TruthSolver, LeavesOutRedundantRods) {
  // 7 movable corners: 21 coordinates, 3 of which are left to the rigid box; 28 rods, 10 too many.
  expect_same(test::braced_box(), 21, 10);
  // With mass, the 15 loops that do not pass through the anchor are welds.
  expect_same(test::braced_box(2), 6 + 3 * 15, 10);
}

// Elastic rods tie nothing, but the mass of one couples its ends, in a tree and where it closes a loop.
TEST(TruthSolver, CountsElasticRodsByTheirMassAlone) {
  const auto soften = [](Scene scene, std::size_t every) {
    for (std::size_t r = 0; r < scene.rods.size(); r += every) scene.rods[r].law = {.stiffness = 1e3};
    return scene;
  };
  expect_same(soften(scenes::make_chain(20), 3), 0, 0);
  expect_same(soften(scenes::make_tree(), 1), 0, 0);
  expect_same(soften(scenes::make_tree(), 2), 0, 0);
  expect_same(soften(scenes::make_tree(), 2), 0, 0, MassModel::lumped);
  // Without mass an elastic rod closes nothing. With mass it is still welded in by three equations.
  expect_same(soften(test::hung_ring(0), 8), 0, 0);
  expect_same(soften(test::hung_ring(1), 1), 3, 0);
  expect_same(soften(test::hung_ring(1), 1), 0, 0, MassModel::lumped);
}

TEST(TruthSolver, RefusesTooManyLoops) {
  const Model model = make_model(scenes::make_net(40, 40), MassModel::consistent);
  try {
    ConstraintSolver solver(model);
    FAIL() << "not refused";
  } catch (const Unreachable& error) {
    EXPECT_NE(std::string(error.what()).find("1522 equations"), std::string::npos) << error.what();
  }
}

// A rod whose mass sits in its middle has no inertia about it.
TEST(TruthSolver, RefusesMotionWithoutInertia) {
  Scene scene;
  scene.particles = {test::loose({0, 0, 0}), test::loose({1, 0, 0})};
  scene.rods = {{.a = 0, .b = 1, .mass = 1, .inertia = 0.0}};
  const Model model = make_model(scene, MassModel::consistent);
  ConstraintSolver solver(model);
  EXPECT_THROW(solver.factor(start_of(scene, model).x), Unreachable);
}

TEST(SpanningTree, HoldsEveryMovableParticleOnce) {
  const Scene scene = test::hung_ring(1);
  const Model model = make_model(scene, MassModel::consistent);
  const SpanningTree tree = grow_spanning_tree(model);
  std::vector<int> seen(model.particles(), 0);
  for (std::size_t i = 0; i < model.particles(); ++i) seen[i] = model.fixed[i];
  for (const TreeNode& node : tree.nodes) {
    EXPECT_TRUE(seen[node.parent]) << "parents come first";
    EXPECT_EQ(seen[node.particle]++, 0);
  }
  EXPECT_EQ(tree.nodes.size() + tree.chords.size(), scene.rods.size());
}

TEST(PivotedCholesky, RevealsRank) {
  // A Gram matrix of four vectors in a plane.
  const Real v[4][2] = {{1, 2}, {2, 4}, {-1, 3}, {0, 1}};
  std::vector<Real> full(16), unit(4);
  for (std::size_t i = 0; i < 4; ++i) {
    for (std::size_t j = 0; j < 4; ++j) full[4 * i + j] = v[i][0] * v[j][0] + v[i][1] * v[j][1];
    unit[i] = full[5 * i];
  }
  PivotedCholesky cholesky;
  cholesky.factor(full, unit, 1e-13L);
  EXPECT_EQ(cholesky.dependent().size(), 2u);
  // What the plane vector (3, -5) is to each of them; whatever combination comes out must be it again.
  std::vector<Real> r(4);
  for (std::size_t i = 0; i < 4; ++i) r[i] = 3 * v[i][0] - 5 * v[i][1];
  cholesky.solve(r);
  Real x = 0, y = 0;
  for (std::size_t i = 0; i < 4; ++i) x += r[i] * v[i][0], y += r[i] * v[i][1];
  EXPECT_NEAR(static_cast<double>(x), 3, 1e-15);
  EXPECT_NEAR(static_cast<double>(y), -5, 1e-15);
}

}  // namespace
}  // namespace plumb::truth::PLUMB_TEST_FILE
