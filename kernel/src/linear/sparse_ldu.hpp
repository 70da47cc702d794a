#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "plumb/layouts/aligned_buffer.hpp"
#include "simd/front/front_kernels.hpp"

namespace plumb::detail {

/// The graph of a square matrix with a symmetric pattern: variables of one or more numbers each, and which of
/// them meet.
struct SparsePattern {
  std::vector<std::uint32_t> size;  ///< numbers per variable
  std::vector<std::pair<std::uint32_t, std::uint32_t>> meet;
  std::vector<std::uint32_t> order;  ///< variables in the order of their elimination
};

/// Where a value goes: added at row `row_part` of variable `row`, column `column_part` of variable `column`.
struct SparseEntry {
  std::uint32_t row, row_part, column, column_part, value;
};

/// What factorisations of one pattern share: the tree of fronts, dense blocks in which variables with the
/// same neighbours are eliminated together (Duff, Reid 1983; Liu 1992), and where every number goes.
class SparseAnalysis {
 public:
  SparseAnalysis(const SparsePattern& pattern, std::span<const SparseEntry> entries);

  std::size_t size() const { return size_; }            ///< numbers in a vector
  std::size_t factor_size() const { return numbers_; }  ///< numbers in a factor
  double operations() const { return operations_; }     ///< multiplications in a factorisation
  std::uint32_t position(std::uint32_t variable) const { return position_[variable]; }

  /// Multiplications that an order costs, without the rest.
  static double estimate(const SparsePattern& pattern);

 private:
  friend class SparseLdu;
  struct Place {
    std::uint32_t at, value;
  };
  struct Front {
    std::uint32_t first, pivots, rows;  ///< rows: pivots and those that they fill
    std::uint32_t stride;               ///< rows with padding
    std::uint32_t parent;
    std::size_t row_begin;    ///< into rows_: rows after the pivots
    std::size_t place_begin;  ///< into places_
    std::size_t factor;       ///< into L and U, pivots x stride
    std::uint32_t child_begin, child_end;
  };
  struct Symbolic;

  static Symbolic analyse(const SparsePattern& pattern);
  std::vector<std::uint32_t> find_fronts(const Symbolic& s);
  void link_fronts(const Symbolic& s, const std::vector<std::uint32_t>& front_of,
                   std::span<const SparseEntry> entries);

  std::size_t size_ = 0, numbers_ = 0, stack_ = 0;
  std::size_t padded_ = 0;    ///< numbers in L or U with padding
  std::uint32_t widest_ = 0;  ///< stride
  double operations_ = 0;
  std::vector<Front> fronts_;
  std::vector<std::uint32_t> rows_, relative_, position_, children_;
  std::vector<Place> places_;
};

/// L U of an unsymmetric matrix, no exchange of rows. Always the same operations in the same order.
/// Allocates when made, and never again.
class SparseLdu {
 public:
  SparseLdu(const SparseAnalysis& analysis, Isa isa);

  /// `smallest` holds, per number of a vector, the pivot at or below which an equation follows from others:
  /// it is left out and its unknown stays 0. Returns how many were.
  std::uint32_t factorize(std::span<const double> values, std::span<const double> smallest);
  /// The solution in place of the right-hand side, both as position() says.
  void solve(std::span<double> x);
  /// Whether the last factorisation left out the equation at a position.
  bool left_out(std::uint32_t position) const { return inverse_[position] == 0; }

 private:
  simd::FrontView view(const SparseAnalysis::Front& front);

  const SparseAnalysis* analysis_;
  const simd::FrontKernels* kernels_;
  layouts::AlignedBuffer<double> upper_, lower_, inverse_;
  layouts::AlignedBuffer<double> block_, x_;  ///< of the front at work
  std::vector<double> stack_;                 ///< what fronts pass on to their parents
};

}  // namespace plumb::detail
