#pragma once

#include <Eigen/SparseCore>
#include <memory>

namespace plumb::detail {

/// Factorises a sparse symmetric matrix as L D Lᵀ without pivoting, and reads its lower triangle. The code is
/// Eigen's, compiled once instead of in every file that factorises.
class SparseCholesky {
 public:
  using Matrix = Eigen::SparseMatrix<double>;

  SparseCholesky();
  ~SparseCholesky();
  SparseCholesky(SparseCholesky&&) noexcept;
  SparseCholesky& operator=(SparseCholesky&&) noexcept;

  /// Finds an order for all matrices with this pattern.
  void analyze(const Matrix& matrix);
  /// Factorises a matrix with the pattern that was analysed. Returns false if a pivot is zero.
  bool factorize(const Matrix& matrix);
  /// Says whether all pivots of the last factorisation were above zero.
  bool is_positive() const;
  void solve(const Eigen::VectorXd& right, Eigen::VectorXd& out) const;

 private:
  struct Factor;
  std::unique_ptr<Factor> factor_;
};

}  // namespace plumb::detail
