#include "sparse_ldu.hpp"

#include <algorithm>
#include <cmath>

namespace plumb::detail {
namespace {

using Index = std::uint32_t;
constexpr Index panel = 32;

/// c[i][j] -= sum over k of a[i][k] b[k][j], for one row of up to four, eight columns at a time in registers.
template <Index rows>
void subtract_rows(double* c, const double* a, const double* b, Index stride, Index depth, Index columns) {
  constexpr Index tile = 4;
  Index j = 0;
  for (; j + tile <= columns; j += tile) {
    double sum[rows][tile];
    for (Index i = 0; i < rows; ++i)
      for (Index t = 0; t < tile; ++t) sum[i][t] = c[std::size_t{i} * stride + j + t];
    for (Index k = 0; k < depth; ++k) {
      const double* from = b + std::size_t{k} * stride + j;
      for (Index i = 0; i < rows; ++i) {
        const double factor = a[std::size_t{i} * stride + k];
        for (Index t = 0; t < tile; ++t) sum[i][t] -= factor * from[t];
      }
    }
    for (Index i = 0; i < rows; ++i)
      for (Index t = 0; t < tile; ++t) c[std::size_t{i} * stride + j + t] = sum[i][t];
  }
  for (; j < columns; ++j)
    for (Index i = 0; i < rows; ++i) {
      double sum = c[std::size_t{i} * stride + j];
      for (Index k = 0; k < depth; ++k)
        sum -= a[std::size_t{i} * stride + k] * b[std::size_t{k} * stride + j];
      c[std::size_t{i} * stride + j] = sum;
    }
}

void subtract_product(double* c, const double* a, const double* b, Index stride, Index rows, Index depth,
                      Index columns) {
  Index i = 0;
  for (; i + 4 <= rows; i += 4)
    subtract_rows<4>(c + std::size_t{i} * stride, a + std::size_t{i} * stride, b, stride, depth, columns);
  for (; i < rows; ++i)
    subtract_rows<1>(c + std::size_t{i} * stride, a + std::size_t{i} * stride, b, stride, depth, columns);
}

}  // namespace

SparseLdu::SparseLdu(const SparseAnalysis& analysis)
    : analysis_(&analysis),
      factor_(analysis.numbers_),
      inverse_(analysis.size_),
      front_(std::size_t{analysis.widest_} * analysis.widest_),
      stack_(analysis.stack_) {}

std::uint32_t SparseLdu::factorize(std::span<const double> values, std::span<const double> smallest) {
  const SparseAnalysis& a = *analysis_;
  dropped_ = 0;
  std::size_t top = 0;
  for (std::size_t f = 0; f < a.fronts_.size(); ++f) {
    const SparseAnalysis::Front& front = a.fronts_[f];
    const std::size_t rows = front.rows, rest = front.rows - front.pivots;
    std::fill_n(front_.data(), rows * rows, 0.0);
    const std::size_t places_end = f + 1 < a.fronts_.size() ? a.fronts_[f + 1].place_begin : a.places_.size();
    for (std::size_t p = front.place_begin; p < places_end; ++p)
      front_[a.places_[p].at] += values[a.places_[p].value];
    for (Index at = front.child_end; at-- > front.child_begin;) {
      const SparseAnalysis::Front& child = a.fronts_[a.children_[at]];
      const std::size_t passed = child.rows - child.pivots;
      const Index* to = a.relative_.data() + child.row_begin;
      top -= passed * passed;
      const double* from = stack_.data() + top;
      for (std::size_t i = 0; i < passed; ++i) {
        double* row = front_.data() + to[i] * rows;
        for (std::size_t j = 0; j < passed; ++j) row[to[j]] += from[i * passed + j];
      }
    }
    eliminate(front, smallest);
    double* out = factor_.data() + front.factor;
    out = std::copy_n(front_.data(), front.pivots * rows, out);
    for (std::size_t i = front.pivots; i < rows; ++i) {
      out = std::copy_n(front_.data() + i * rows, front.pivots, out);
      std::copy_n(front_.data() + i * rows + front.pivots, rest,
                  stack_.data() + top + (i - front.pivots) * rest);
    }
    top += rest * rest;
  }
  return dropped_;
}

/// Blocks of columns: within one, rank by rank; on what is right of and below it, all its ranks at once.
void SparseLdu::eliminate(const SparseAnalysis::Front& front, std::span<const double> smallest) {
  const Index rows = front.rows;
  double* m = front_.data();
  const auto row = [&](Index i) { return m + std::size_t{i} * rows; };
  for (Index begin = 0; begin < front.pivots; begin += panel) {
    const Index end = std::min(begin + panel, front.pivots);
    for (Index k = begin; k < end; ++k) {
      const double pivot = row(k)[k];
      double inverse = 0;
      if (std::abs(pivot) > smallest[front.first + k]) {
        inverse = 1 / pivot;
      } else {
        ++dropped_;
      }
      inverse_[front.first + k] = inverse;
      for (Index i = k + 1; i < rows; ++i) {
        const double factor = row(i)[k] * inverse;
        row(i)[k] = factor;
        if (factor == 0) continue;
        const Index last = i < end ? rows : end;
        for (Index j = k + 1; j < last; ++j) row(i)[j] -= factor * row(k)[j];
      }
    }
    if (end < rows)
      subtract_product(row(end) + end, row(end) + begin, row(begin) + end, rows, rows - end, end - begin,
                       rows - end);
  }
}

void SparseLdu::solve(std::span<double> x) const {
  const SparseAnalysis& a = *analysis_;
  for (const SparseAnalysis::Front& front : a.fronts_) {
    const std::size_t p = front.pivots, rows = front.rows;
    const double* pivots = factor_.data() + front.factor;
    const double* rest = pivots + p * rows;
    double* own = x.data() + front.first;
    for (std::size_t i = 1; i < p; ++i)
      for (std::size_t k = 0; k < i; ++k) own[i] -= pivots[i * rows + k] * own[k];
    for (std::size_t i = p; i < rows; ++i) {
      double sum = 0;
      for (std::size_t k = 0; k < p; ++k) sum += rest[(i - p) * p + k] * own[k];
      x[a.rows_[front.row_begin + i - p]] -= sum;
    }
  }
  for (std::size_t f = a.fronts_.size(); f-- > 0;) {
    const SparseAnalysis::Front& front = a.fronts_[f];
    const std::size_t p = front.pivots, rows = front.rows;
    const double* pivots = factor_.data() + front.factor;
    double* own = x.data() + front.first;
    for (std::size_t k = p; k-- > 0;) {
      double sum = own[k];
      for (std::size_t j = k + 1; j < p; ++j) sum -= pivots[k * rows + j] * own[j];
      for (std::size_t j = p; j < rows; ++j)
        sum -= pivots[k * rows + j] * x[a.rows_[front.row_begin + j - p]];
      own[k] = sum * inverse_[front.first + k];
    }
  }
}

}  // namespace plumb::detail
