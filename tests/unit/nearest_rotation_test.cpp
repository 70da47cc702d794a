// Nearest rotations, against those of Kabsch's method by a singular value decomposition.

#include "math/nearest_rotation.hpp"

#include <gtest/gtest.h>

#include <Eigen/SVD>
#include <cmath>

#include "plumb/joints.hpp"
#include "support/random_trees.hpp"

namespace plumb::detail::PLUMB_TEST_FILE {
namespace {

Eigen::Matrix3d matrix_of(const std::array<Vec3, 3>& columns) {
  Eigen::Matrix3d out;
  for (int i = 0; i < 3; ++i) out.col(i) << columns[i].x, columns[i].y, columns[i].z;
  return out;
}

std::array<Vec3, 3> columns_of(const Eigen::Matrix3d& matrix) {
  std::array<Vec3, 3> out;
  for (int i = 0; i < 3; ++i) out[i] = {matrix(0, i), matrix(1, i), matrix(2, i)};
  return out;
}

/// Returns U diag(1, 1, ±1) Vᵀ, with the sign that makes it a rotation.
Eigen::Matrix3d kabsch(const Eigen::Matrix3d& matrix) {
  const Eigen::JacobiSVD<Eigen::Matrix3d> svd(matrix, Eigen::ComputeFullU | Eigen::ComputeFullV);
  const double sign = (svd.matrixU() * svd.matrixV().transpose()).determinant() < 0 ? -1 : 1;
  return svd.matrixU() * Eigen::Vector3d(1, 1, sign).asDiagonal() * svd.matrixV().transpose();
}

// The error is that of rounding over how far apart singular values are, which is kept above 0.05.
TEST(NearestRotation, IsThatOfKabsch) {
  test::Random random(5);
  int tried = 0, mirroring = 0;
  while (tried < 1000) {
    const std::array<Vec3, 3> columns{test::random_vector(random), test::random_vector(random),
                                      test::random_vector(random)};
    const Eigen::Matrix3d matrix = matrix_of(columns);
    const Eigen::Vector3d values = Eigen::JacobiSVD<Eigen::Matrix3d>(matrix).singularValues();
    const bool mirrors = matrix.determinant() < 0;
    if (values[1] + (mirrors ? -values[2] : values[2]) < 0.05) continue;
    ++tried;
    mirroring += mirrors;
    const std::array<double, 4> q = nearest_rotation(columns);
    EXPECT_NEAR(q[0] * q[0] + q[1] * q[1] + q[2] * q[2] + q[3] * q[3], 1, 1e-14);
    EXPECT_GE(q[0], 0);
    EXPECT_LT((matrix_of(axes_of(q)) - kabsch(matrix)).cwiseAbs().maxCoeff(), 1e-12);
  }
  EXPECT_GT(mirroring, 200) << "so few that the test does not say much";
}

TEST(NearestRotation, OfARotationIsItself) {
  test::Random random(6);
  for (int i = 0; i < 100; ++i) {
    const Vec3 axis = test::random_vector(random);
    const Eigen::Matrix3d turned =
        Eigen::AngleAxisd(3 * test::signed_unit(random), Eigen::Vector3d(axis.x, axis.y, axis.z).normalized())
            .toRotationMatrix();
    for (const double scale : {1e-150, 1.0, 1e150}) {
      const auto axes = axes_of(nearest_rotation(columns_of(scale * turned)));
      EXPECT_LT((matrix_of(axes) - turned).cwiseAbs().maxCoeff(), 1e-14);
    }
  }
}

// Of what is nearest to nothing, any rotation will do.
TEST(NearestRotation, IsARotationWhateverTheMatrix) {
  for (const std::array<Vec3, 3>& columns :
       {std::array<Vec3, 3>{}, {Vec3{-1, 0, 0}, {0, -1, 0}, {0, 0, -1}}, {Vec3{1, 0, 0}, {}, {}}}) {
    const std::array<double, 4> q = nearest_rotation(columns);
    EXPECT_NEAR(q[0] * q[0] + q[1] * q[1] + q[2] * q[2] + q[3] * q[3], 1, 1e-15);
  }
}

}  // namespace
}  // namespace plumb::detail::PLUMB_TEST_FILE
