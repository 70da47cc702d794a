#include "truth/pivoted_cholesky.hpp"

#include <algorithm>
#include <numeric>

namespace plumb::truth {

void PivotedCholesky::factor(const std::vector<Real>& full, const std::vector<Real>& unit, Real least) {
  const std::size_t k = unit.size();
  std::vector<Real> left(k);
  for (std::size_t i = 0; i < k; ++i) left[i] = full[i * k + i];
  pivots_.resize(k);
  std::iota(pivots_.begin(), pivots_.end(), 0u);
  lower_.assign(k, std::vector<Real>{});
  std::size_t rank = 0;
  for (; rank < k; ++rank) {
    std::size_t best = rank;
    for (std::size_t i = rank + 1; i < k; ++i) {
      const std::uint32_t p = pivots_[i], q = pivots_[best];
      if (left[p] * unit[q] > left[q] * unit[p]) best = i;
    }
    const std::uint32_t pivot = pivots_[best];
    if (!(left[pivot] > least * unit[pivot])) break;
    std::swap(pivots_[rank], pivots_[best]);
    std::swap(lower_[rank], lower_[best]);
    const Real root = std::sqrt(left[pivot]);
    const std::vector<Real>& above = lower_[rank];
    for (std::size_t i = rank + 1; i < k; ++i) {
      std::vector<Real>& row = lower_[i];
      Real value = full[pivots_[i] * k + pivot];
      for (std::size_t j = 0; j < rank; ++j) value -= row[j] * above[j];
      row.push_back(value / root);
      left[pivots_[i]] -= row.back() * row.back();
    }
    lower_[rank].push_back(root);
  }
  dependent_.assign(pivots_.begin() + static_cast<std::ptrdiff_t>(rank), pivots_.end());
  pivots_.resize(rank);
  lower_.resize(rank);
}

void PivotedCholesky::solve(std::vector<Real>& r) const {
  const std::size_t rank = pivots_.size();
  std::vector<Real> y(rank);
  for (std::size_t i = 0; i < rank; ++i) {
    Real value = r[pivots_[i]];
    for (std::size_t j = 0; j < i; ++j) value -= lower_[i][j] * y[j];
    y[i] = value / lower_[i][i];
  }
  std::fill(r.begin(), r.end(), Real{0});
  for (std::size_t i = rank; i-- > 0;) {
    const Real value = y[i] / lower_[i][i];
    r[pivots_[i]] = value;
    for (std::size_t j = 0; j < i; ++j) y[j] -= lower_[i][j] * value;
  }
}

}  // namespace plumb::truth
