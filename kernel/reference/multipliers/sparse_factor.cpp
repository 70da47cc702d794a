#include <cmath>

#include "linear/sparse_cholesky.hpp"
#include "reference/multipliers/rod_equations.hpp"
#include "reference/multipliers/small_matrices.hpp"

namespace plumb::detail {
namespace {

using Matrix = SparseCholesky::Matrix;

/// Factorises [[M, Jᵀ], [J, -S]] in x and -lambda. The matrix is quasi-definite, so that an LDLᵀ
/// factorisation without pivots exists in any order (Vanderbei 1995). It is scaled so that the diagonal of M
/// and that of J diag(M)^-1 Jᵀ are one.
class SparseFactor final : public RodFactor {
 public:
  explicit SparseFactor(const RodEquations& equations) : equations_(equations) {
    const auto n = equations.unknowns(), rows = static_cast<Eigen::Index>(equations.rows.size());
    for (const double mass : equations.mass) node_scale_.push_back(1 / std::sqrt(mass));
    scale_.resize(n + rows);
    for (Eigen::Index i = 0; i < n; ++i) scale_[i] = node_scale_[static_cast<std::size_t>(i / 3)];
    right_.resize(n + rows);
    solution_.resize(n + rows);

    Array<Eigen::Triplet<double>> entries;
    const auto add = [&](Eigen::Index row, Eigen::Index column, double value) {
      entries.emplace_back(std::max(row, column), std::min(row, column), value);
    };
    for (Eigen::Index i = 0; i < n; ++i) add(i, i, 1);
    for (Eigen::Index r = 0; r < rows; ++r) {
      const RodEquations::Row& row = equations.rows[static_cast<std::size_t>(r)];
      add(n + r, n + r, -1);
      for (int k = 0; k < 3; ++k) {
        add(n + r, 3 * row.a + k, 1);
        if (row.b == RodEquations::none) continue;
        add(n + r, 3 * row.b + k, 1);
        if (row.coupling != 0)
          add(3 * row.a + k, 3 * row.b + k, row.coupling * node_scale_[row.a] * node_scale_[row.b]);
      }
    }
    matrix_.resize(n + rows, n + rows);
    matrix_.setFromTriplets(entries.begin(), entries.end());
    matrix_.makeCompressed();
    const auto place = [&](Eigen::Index row, Eigen::Index column) {
      return &matrix_.coeffRef(row, column) - matrix_.valuePtr();
    };
    for (Eigen::Index r = 0; r < rows; ++r) {
      const RodEquations::Row& row = equations.rows[static_cast<std::size_t>(r)];
      Places& places = places_.emplace_back();
      places.diagonal = place(n + r, n + r);
      for (int k = 0; k < 3; ++k) {
        places.a[k] = place(n + r, 3 * row.a + k);
        if (row.b != RodEquations::none) places.b[k] = place(n + r, 3 * row.b + k);
      }
    }
    factor_.analyze(matrix_);
  }

  void factorize(const Array<Vec3>& directions) override {
    const Eigen::Index n = equations_.unknowns();
    double* values = matrix_.valuePtr();
    for (std::size_t r = 0; r < places_.size(); ++r) {
      const RodEquations::Row& row = equations_.rows[r];
      const Vec3 d = directions[r];
      const double a = node_scale_[row.a], b = row.b == RodEquations::none ? 0 : node_scale_[row.b];
      const double size2 = dot(d, d) * (a * a + b * b);
      const double scale = 1 / std::sqrt(size2);
      scale_[n + static_cast<Eigen::Index>(r)] = scale;
      values[places_[r].diagonal] = -row.compliance * dot(d, d) * scale * scale;
      const double part[3] = {d.x * scale, d.y * scale, d.z * scale};
      for (int k = 0; k < 3; ++k) {
        values[places_[r].a[k]] = a * part[k];
        if (row.b != RodEquations::none) values[places_[r].b[k]] = -b * part[k];
      }
    }
    factor_.factorize(matrix_);
  }

  void solve(const Eigen::VectorXd& f, const Eigen::VectorXd& c, Eigen::VectorXd& x,
             Eigen::VectorXd& lambda) override {
    right_ << f, c;
    right_ = scale_.cwiseProduct(right_);
    factor_.solve(right_, solution_);
    solution_ = scale_.cwiseProduct(solution_);
    x = solution_.head(f.size());
    lambda = -solution_.tail(c.size());
  }

 private:
  /// Says where a row's entries are in the values of the matrix.
  struct Places {
    Eigen::Index diagonal = 0, a[3] = {}, b[3] = {};
  };

  const RodEquations& equations_;
  Array<double> node_scale_;
  Array<Places> places_;
  Matrix matrix_;
  SparseCholesky factor_;
  Eigen::VectorXd scale_, right_, solution_;
};

}  // namespace

std::unique_ptr<RodFactor> make_sparse_factor(const RodEquations& equations) {
  return std::make_unique<SparseFactor>(equations);
}

}  // namespace plumb::detail
