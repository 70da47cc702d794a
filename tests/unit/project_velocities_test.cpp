// The projection of velocities onto what rods allow, and the factorisation that it takes.

#include "scene/project_velocities.hpp"

#include <gtest/gtest.h>

#include <Eigen/Core>

#include "linear/sparse_cholesky.hpp"
#include "scenes/generators/generators.hpp"
#include "support/random_trees.hpp"
#include "support/worlds.hpp"

namespace plumb::detail::PLUMB_TEST_FILE {
namespace {

std::vector<double> inverse_masses(const Scene& scene) {
  std::vector<double> out;
  for (const Particle& particle : scene.particles) out.push_back(particle.fixed ? 0 : 1 / particle.mass);
  return out;
}

// After it no rod's length changes, it changes nothing again, and by impulses along rods linear momentum
// stays. 1e-13 of velocities of about 1 m/s is the rounding of a chain of 20.
TEST(ProjectVelocities, LeavesWhatRodsAllow) {
  test::Random random(9);
  Scene scene = scenes::make_chain(20, 0.1, 10);
  scene.particles[0] = test::movable(scene.particles[0].position, 3);
  Array<Vec3> v(scene.particles.size());
  Vec3 before{}, after{};
  for (std::size_t i = 0; i < v.size(); ++i) {
    v[i] = test::random_vector(random);
    before += scene.particles[i].mass * v[i];
  }
  EXPECT_GT(test::largest_stretching_rate(scene, v), 0.1);
  EXPECT_GT(project_velocities(scene, inverse_masses(scene), v), 0.1);
  EXPECT_LE(test::largest_stretching_rate(scene, v), 1e-13);
  for (std::size_t i = 0; i < v.size(); ++i) after += scene.particles[i].mass * v[i];
  EXPECT_LE(norm(after - before), 1e-12);
  EXPECT_LE(project_velocities(scene, inverse_masses(scene), v), 1e-13);
}

// What does not pull is left alone, bit for bit.
TEST(ProjectVelocities, DoesNothingWhereNothingPulls) {
  const Scene scene = scenes::make_net(3, 3);
  Array<Vec3> v(scene.particles.size());
  EXPECT_EQ(project_velocities(scene, inverse_masses(scene), v), 0);
  for (const Vec3 each : v) EXPECT_EQ(each, Vec3{});
}

Eigen::SparseMatrix<double> sparse(const Eigen::MatrixXd& dense) {
  return dense.sparseView();
}

TEST(SparseCholesky, SolvesAndKnowsTheSignsOfPivots) {
  test::Random random(10);
  Eigen::MatrixXd m = Eigen::MatrixXd::Zero(12, 12);
  for (Eigen::Index i = 0; i < 12; ++i) {
    m(i, i) = 4;
    if (i >= 3) m(i, i - 3) = m(i - 3, i) = test::signed_unit(random);
  }
  SparseCholesky factor;
  factor.analyze(sparse(m));
  ASSERT_TRUE(factor.factorize(sparse(m)));
  EXPECT_TRUE(factor.is_positive());
  const Eigen::VectorXd right = Eigen::VectorXd::LinSpaced(12, -1, 1);
  Eigen::VectorXd x;
  factor.solve(right, x);
  EXPECT_LE((m * x - right).norm(), 1e-14);

  // The same pattern, indefinite: it still solves, and says so.
  m.diagonal()[5] = -4;
  ASSERT_TRUE(factor.factorize(sparse(m)));
  EXPECT_FALSE(factor.is_positive());
  factor.solve(right, x);
  EXPECT_LE((m * x - right).norm(), 1e-14);
}

}  // namespace
}  // namespace plumb::detail::PLUMB_TEST_FILE
