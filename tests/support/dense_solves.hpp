#pragma once

#include <Eigen/Core>

/// Dense matrices to compare with, solved in a file of their own: each of Eigen's decompositions takes a
/// compiler as long as a whole test.
namespace plumb::test {

using Real = long double;
using DenseMatrix = Eigen::Matrix<Real, Eigen::Dynamic, Eigen::Dynamic>;
using DenseVector = Eigen::Matrix<Real, Eigen::Dynamic, 1>;

/// Solves matrix * x = right by complete orthogonal decomposition. Where several x do, returns the least.
DenseVector solve_dense(const DenseMatrix& matrix, const DenseVector& right);
/// Returns the rank of a matrix: its pivots that are more than `threshold` of the largest.
Eigen::Index rank_of(const DenseMatrix& matrix, Real threshold);
/// Returns the least eigenvalue of a symmetric matrix, in double.
double least_eigenvalue(const DenseMatrix& matrix);
/// Returns the largest eigenvalue of mass⁻¹ stiffness, both symmetric, in double.
double largest_eigenvalue(const DenseMatrix& stiffness, const DenseMatrix& mass);

}  // namespace plumb::test
