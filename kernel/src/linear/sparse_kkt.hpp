#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <utility>

#include "plumb/layouts/memory.hpp"
#include "simd/kkt/kkt_kernels.hpp"

namespace plumb::detail {

/// Returns the numbers of blocks or quads, one after the other.
template <class Numbers>
std::span<double> numbers(Array<Numbers>& of) {
  return {of.front().of, of.size() * (sizeof(Numbers) / sizeof(double))};
}

/// This plan is for the factors L D Lᵀ of symmetric matrices of one pattern,
///   [M Jᵀ; J -e],
/// with M positive definite and e tiny. They are quasi-definite, so every order of elimination has factors
/// without pivoting (Vanderbei 1995). A rod with inertia 0 on particles without mass has a singular M, and
/// factor() fails.
///
/// The first unknowns are those of M in threes, the others are constraints. Matrices are small and unknowns
/// have few neighbours, so blocks have four of them, a vector of AVX2. A block holds a triple with a
/// constraint of its own if it has one, or up to four constraints. Where it has no unknown there is a row of
/// the unit matrix, and zero in vectors.
class KktPlan {
 public:
  KktPlan() = default;
  /// Plans for `threes` triples of unknowns, then `constraints`. `couplings` are the places off the diagonal,
  /// in any order, each once or twice.
  KktPlan(std::uint32_t threes, std::uint32_t constraints,
          std::span<const std::pair<std::uint32_t, std::uint32_t>> couplings, Isa isa);

  std::uint32_t columns() const { return columns_; }
  /// Counts the numbers of a vector, those without an unknown included.
  std::uint32_t unknowns() const { return 4 * columns_; }
  /// Counts the blocks that a matrix, and then its factors, take.
  std::size_t blocks() const { return columns_ + rows_.size(); }
  /// Says where the entry of two unknowns is among the numbers of the blocks. That of one with itself is on
  /// the diagonal.
  std::uint32_t place(std::uint32_t a, std::uint32_t b) const;
  /// Says where on the diagonal the unknown at a position has its entry.
  static std::uint32_t own_place(std::uint32_t position) { return 16 * (position / 4) + 5 * (position % 4); }
  /// Writes zeros, and ones on the diagonal where no unknown stands, so that blocks have inverses.
  void clear(std::span<simd::Block> matrix) const;
  /// Says where an unknown stands in vectors that are solved.
  std::uint32_t position(std::uint32_t unknown) const { return position_[unknown]; }

  /// Turns a matrix into its factors. Returns false if a pivot is zero or not finite.
  bool factor(std::span<simd::Block> blocks) const;
  void solve(std::span<const simd::Block> factors, std::span<simd::Quad> x) const;
  /// Returns the pattern as KktKernels takes it.
  simd::KktPattern pattern() const { return {columns_, start_.data(), rows_.data()}; }

 private:
  std::uint32_t block(std::uint32_t column, std::uint32_t row) const;
  void find_targets();

  const simd::KktKernels* kernels_ = nullptr;
  std::uint32_t columns_ = 0;
  Array<std::uint32_t> position_;
  Array<std::uint32_t> padding_;  ///< These positions have no unknown.
  Array<std::uint32_t> start_;    ///< Every column's blocks below the diagonal begin here, by elimination.
  Array<std::uint32_t> rows_;     ///< These are their rows, by elimination, ascending.
  Array<std::uint32_t> targets_;  ///< factor() updates these blocks, in its order.
};

}  // namespace plumb::detail
