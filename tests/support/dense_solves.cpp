#include "support/dense_solves.hpp"

#include <Eigen/Eigenvalues>
#include <Eigen/QR>

namespace plumb::test {

DenseVector solve_dense(const DenseMatrix& matrix, const DenseVector& right) {
  return matrix.completeOrthogonalDecomposition().solve(right);
}

Eigen::Index rank_of(const DenseMatrix& matrix, Real threshold) {
  auto decomposed = matrix.completeOrthogonalDecomposition();
  decomposed.setThreshold(threshold);
  return decomposed.rank();
}

double least_eigenvalue(const DenseMatrix& matrix) {
  return Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd>(matrix.cast<double>(), Eigen::EigenvaluesOnly)
      .eigenvalues()
      .minCoeff();
}

double largest_eigenvalue(const DenseMatrix& stiffness, const DenseMatrix& mass) {
  return Eigen::GeneralizedSelfAdjointEigenSolver<Eigen::MatrixXd>(
             stiffness.cast<double>(), mass.cast<double>(), Eigen::EigenvaluesOnly)
      .eigenvalues()
      .maxCoeff();
}

}  // namespace plumb::test
