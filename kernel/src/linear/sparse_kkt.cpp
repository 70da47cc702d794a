#include "linear/sparse_kkt.hpp"

#include <algorithm>
#include <cmath>
#include <stdexcept>

#include "linear/kkt_order.hpp"

namespace plumb::detail {

KktPlan::KktPlan(std::uint32_t threes, std::uint32_t constraints,
                 std::span<const std::pair<std::uint32_t, std::uint32_t>> couplings, Isa isa)
    : kernels_(&simd::kkt_kernels(isa)) {
  const KktGraph graph(threes, constraints, couplings);
  const KktOrder order = order_columns(graph);
  position_.resize(3 * std::size_t{threes} + constraints);
  for (const Array<std::uint32_t>& nodes : order.columns) {
    std::uint32_t at = 4 * columns_;
    const auto put = [&](std::uint32_t unknown) { position_[unknown] = at++; };
    for (const std::uint32_t n : nodes) {
      if (graph.is_triple(n))
        for (std::uint32_t axis = 0; axis < 3; ++axis) put(3 * n + axis);
      else
        put(n + 2 * threes);
    }
    ++columns_;
    while (at < 4 * columns_) padding_.push_back(at++);
  }
  start_.assign(1, 0);
  for (const Array<std::uint32_t>& rows : order.rows) {
    rows_.insert(rows_.end(), rows.begin(), rows.end());
    start_.push_back(static_cast<std::uint32_t>(rows_.size()));
  }
  find_targets();
}

void KktPlan::find_targets() {
  // Columns that have a row, and where they have it.
  Array<Array<std::pair<std::uint32_t, std::uint32_t>>> having(columns_);
  Array<std::size_t> first(columns_ + std::size_t{1}, 0);  // target of a column
  for (std::uint32_t k = 0; k < columns_; ++k) {
    const std::size_t tiles = start_[k + 1] - start_[k];
    first[k + 1] = first[k] + tiles * (tiles + 1) / 2;
    for (std::uint32_t i = start_[k]; i < start_[k + 1]; ++i) having[rows_[i]].emplace_back(k, i);
  }
  targets_.resize(first.back());
  Array<std::uint32_t> tile_of(columns_);  // of a row, in the column of now
  for (std::uint32_t column = 0; column < columns_; ++column) {
    tile_of[column] = column;
    for (std::uint32_t i = start_[column]; i < start_[column + 1]; ++i) tile_of[rows_[i]] = columns_ + i;
    for (const auto& [k, i] : having[column]) {
      const std::size_t left = start_[k + 1] - i;
      auto target = targets_.begin() + static_cast<std::ptrdiff_t>(first[k + 1] - left * (left + 1) / 2);
      for (std::uint32_t j = i; j < start_[k + 1]; ++j) *target++ = tile_of[rows_[j]];
    }
  }
}

std::uint32_t KktPlan::block(std::uint32_t column, std::uint32_t row) const {
  if (column == row) return column;
  const auto first = rows_.begin() + start_[column], last = rows_.begin() + start_[column + 1];
  const auto found = std::lower_bound(first, last, row);
  if (found == last || *found != row) throw std::logic_error("no such entry in the pattern");
  return static_cast<std::uint32_t>(columns_ + static_cast<std::size_t>(found - rows_.begin()));
}

std::uint32_t KktPlan::place(std::uint32_t a, std::uint32_t b) const {
  const auto [low, high] = std::minmax(position_[a], position_[b]);
  return 16 * block(low / 4, high / 4) + 4 * (low % 4) + high % 4;
}

void KktPlan::clear(std::span<simd::Block> matrix) const {
  std::fill(matrix.begin(), matrix.end(), simd::Block{});
  for (const std::uint32_t at : padding_) matrix[at / 4].of[5 * (at % 4)] = 1;
}

bool KktPlan::factor(std::span<simd::Block> blocks) const {
  kernels_->factor(pattern(), targets_.data(), blocks.data());
  return std::all_of(blocks.begin(), blocks.begin() + columns_, [](const simd::Block& inverse) {
    return std::isfinite(inverse.of[12] + inverse.of[13] + inverse.of[14] + inverse.of[15]);
  });
}

void KktPlan::solve(std::span<const simd::Block> factors, std::span<simd::Quad> x) const {
  kernels_->solve(pattern(), factors.data(), x.data());
}

}  // namespace plumb::detail
