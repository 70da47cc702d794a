#pragma once

#include <cstdint>
#include <span>

#include "plumb/layouts/aligned_buffer.hpp"
#include "plumb/layouts/memory.hpp"
#include "simd/front/front_kernels.hpp"

namespace plumb::detail {

/// A square matrix with a symmetric pattern has a graph: its variables consist of one or more numbers each,
/// and some of them meet.
struct SparsePattern {
  Array<std::uint32_t> size;  ///< Each variable has so many numbers.
  Array<std::pair<std::uint32_t, std::uint32_t>> meet;
  Array<std::uint32_t> order;  ///< Variables are eliminated in this order.
};

/// A value is added at row `row_part` of variable `row` and column `column_part` of variable `column`.
struct SparseEntry {
  std::uint32_t row, row_part, column, column_part, value;
};

/// Factorisations of one pattern share the tree of fronts and the place of every number. Fronts are dense
/// blocks in which variables with the same neighbours are eliminated together (Duff, Reid 1983; Liu 1992).
class SparseAnalysis {
 public:
  SparseAnalysis(const SparsePattern& pattern, std::span<const SparseEntry> entries);

  std::size_t size() const { return size_; }            ///< Counts numbers in a vector.
  std::size_t factor_size() const { return numbers_; }  ///< Counts numbers in a factor.
  double operations() const { return operations_; }     ///< Counts multiplications in a factorisation.
  std::uint32_t position(std::uint32_t variable) const { return position_[variable]; }

  /// Counts the multiplications that an order costs, and finds nothing else.
  static double estimate(const SparsePattern& pattern);

 private:
  friend class SparseLdu;
  struct Place {
    std::uint32_t at, value;
  };
  struct Front {
    std::uint32_t first, pivots, rows;  ///< Rows are pivots and those that they fill.
    std::uint32_t stride;               ///< It counts rows with padding.
    std::uint32_t parent;
    std::size_t row_begin;    ///< Rows after the pivots begin here in rows_.
    std::size_t place_begin;  ///< Places begin here in places_.
    std::size_t factor;       ///< L and U begin here, with pivots x stride numbers.
    std::uint32_t child_begin, child_end;
  };
  struct Symbolic;

  static Symbolic analyse(const SparsePattern& pattern);
  Array<std::uint32_t> find_fronts(const Symbolic& s);
  void link_fronts(const Symbolic& s, const Array<std::uint32_t>& front_of,
                   std::span<const SparseEntry> entries);

  std::size_t size_ = 0, numbers_ = 0, stack_ = 0;
  std::size_t padded_ = 0;    ///< L and U each have so many numbers with padding.
  std::uint32_t widest_ = 0;  ///< It is the largest stride.
  double operations_ = 0;
  Array<Front> fronts_;
  Array<std::uint32_t> rows_, relative_, position_, children_;
  Array<Place> places_;
};

/// Factorises an unsymmetric matrix as L U without exchange of rows, always by the same operations in the
/// same order. It allocates when made, and never again.
class SparseLdu {
 public:
  SparseLdu(const SparseAnalysis& analysis, Isa isa);

  /// Factorises. `smallest` holds, per number of a vector, the pivot at or below which an equation follows
  /// from others. Such an equation is left out, and its unknown stays 0. Returns how many were.
  std::uint32_t factorize(std::span<const double> values, std::span<const double> smallest);
  /// Puts the solution in place of the right-hand side, both as position() says.
  void solve(std::span<double> x);
  /// Lists the numbers of a factorisation.
  template <class Archive>
  void archive(Archive& archive) {
    auto& [analysis, kernels, upper, lower, inverse, block, x, stack] = *this;
    archive(upper, lower, inverse);
  }
  /// Says whether the last factorisation left out the equation at a position.
  bool left_out(std::uint32_t position) const { return inverse_[position] == 0; }

 private:
  simd::FrontView view(const SparseAnalysis::Front& front);

  const SparseAnalysis* analysis_;
  const simd::FrontKernels* kernels_;
  layouts::AlignedBuffer<double> upper_, lower_, inverse_;
  layouts::AlignedBuffer<double> block_, x_;  ///< The front at work is here.
  Array<double> stack_;                       ///< Fronts pass this on to their parents.
};

}  // namespace plumb::detail
