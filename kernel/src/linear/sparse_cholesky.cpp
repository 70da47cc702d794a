#include "linear/sparse_cholesky.hpp"

#include <Eigen/SparseCholesky>

namespace plumb::detail {

struct SparseCholesky::Factor {
  Eigen::SimplicialLDLT<Matrix> ldlt;
};

SparseCholesky::SparseCholesky() : factor_(std::make_unique<Factor>()) {}
SparseCholesky::~SparseCholesky() = default;
SparseCholesky::SparseCholesky(SparseCholesky&&) noexcept = default;
SparseCholesky& SparseCholesky::operator=(SparseCholesky&&) noexcept = default;

void SparseCholesky::analyze(const Matrix& matrix) {
  factor_->ldlt.analyzePattern(matrix);
}

bool SparseCholesky::factorize(const Matrix& matrix) {
  factor_->ldlt.factorize(matrix);
  return factor_->ldlt.info() == Eigen::Success;
}

bool SparseCholesky::is_positive() const {
  return factor_->ldlt.info() == Eigen::Success && factor_->ldlt.vectorD().minCoeff() > 0;
}

void SparseCholesky::solve(const Eigen::VectorXd& right, Eigen::VectorXd& out) const {
  out = factor_->ldlt.solve(right);
}

}  // namespace plumb::detail
