#include "linear/sparse_ldu.hpp"

#include <algorithm>

namespace plumb::detail {

SparseLdu::SparseLdu(const SparseAnalysis& analysis, Isa isa)
    : analysis_(&analysis),
      kernels_(&simd::front_kernels(isa)),
      upper_(analysis.padded_),
      lower_(analysis.padded_),
      inverse_(analysis.size_),
      block_(std::size_t{analysis.widest_} * analysis.widest_),
      x_(analysis.widest_),
      stack_(analysis.stack_) {}

simd::FrontView SparseLdu::view(const SparseAnalysis::Front& front) {
  return {front.rows,
          front.pivots,
          front.stride,
          upper_.data() + front.factor,
          lower_.data() + front.factor,
          inverse_.data() + front.first};
}

std::uint32_t SparseLdu::factorize(std::span<const double> values, std::span<const double> smallest) {
  const SparseAnalysis& a = *analysis_;
  std::uint32_t left_out = 0;
  std::size_t top = 0;
  for (std::size_t f = 0; f < a.fronts_.size(); ++f) {
    const SparseAnalysis::Front& front = a.fronts_[f];
    const std::size_t stride = front.stride, rest = front.rows - front.pivots;
    std::fill_n(block_.data(), front.rows * stride, 0.0);
    const std::size_t places_end = f + 1 < a.fronts_.size() ? a.fronts_[f + 1].place_begin : a.places_.size();
    for (std::size_t p = front.place_begin; p < places_end; ++p)
      block_[a.places_[p].at] += values[a.places_[p].value];
    for (std::uint32_t at = front.child_end; at-- > front.child_begin;) {
      const SparseAnalysis::Front& child = a.fronts_[a.children_[at]];
      const std::size_t passed = child.rows - child.pivots;
      const std::uint32_t* to = a.relative_.data() + child.row_begin;
      top -= passed * passed;
      const double* from = stack_.data() + top;
      for (std::size_t i = 0; i < passed; ++i) {
        double* row = block_.data() + to[i] * stride;
        for (std::size_t j = 0; j < passed; ++j) row[to[j]] += from[i * passed + j];
      }
    }
    left_out += kernels_->eliminate(view(front), block_.data(), smallest.data() + front.first);
    for (std::size_t i = front.pivots; i < front.rows; ++i, top += rest)
      std::copy_n(block_.data() + i * stride + front.pivots, rest, stack_.data() + top);
  }
  return left_out;
}

void SparseLdu::solve(std::span<double> x) {
  const SparseAnalysis& a = *analysis_;
  for (const SparseAnalysis::Front& front : a.fronts_) {
    const std::uint32_t rest = front.rows - front.pivots;
    const std::uint32_t* to = a.rows_.data() + front.row_begin;
    double* own = x.data() + front.first;
    std::copy_n(own, front.pivots, x_.data());
    std::fill(x_.data() + front.pivots, x_.data() + front.stride, 0.0);
    kernels_->forward(view(front), x_.data());
    std::copy_n(x_.data(), front.pivots, own);
    for (std::uint32_t i = 0; i < rest; ++i) x[to[i]] += x_[front.pivots + i];
  }
  for (std::size_t f = a.fronts_.size(); f-- > 0;) {
    const SparseAnalysis::Front& front = a.fronts_[f];
    const std::uint32_t rest = front.rows - front.pivots;
    const std::uint32_t* from = a.rows_.data() + front.row_begin;
    double* own = x.data() + front.first;
    std::copy_n(own, front.pivots, x_.data());
    for (std::uint32_t i = 0; i < rest; ++i) x_[front.pivots + i] = x[from[i]];
    std::fill(x_.data() + front.rows, x_.data() + front.stride, 0.0);
    kernels_->backward(view(front), x_.data());
    std::copy_n(x_.data(), front.pivots, own);
  }
}

}  // namespace plumb::detail
