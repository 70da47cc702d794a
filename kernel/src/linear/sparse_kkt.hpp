#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <utility>
#include <vector>

#include "simd/kkt/kkt_kernels.hpp"

namespace plumb::detail {

/// The numbers of blocks or quads, one after the other.
template <class Numbers>
std::span<double> numbers(std::vector<Numbers>& of) {
  return {of.front().of, of.size() * (sizeof(Numbers) / sizeof(double))};
}

/// The plan of factors L D Lᵀ of symmetric matrices of one pattern,
///   [M Jᵀ; J -e],
/// M positive definite, e tiny: quasi-definite, so that every order of elimination has factors without
/// pivoting (Vanderbei 1995). A rod with inertia 0 on particles without mass has a singular M, and factor()
/// fails. The first unknowns are those of M in threes, the others constraints. Small matrices with few
/// neighbours: in blocks of four, a vector of AVX2, a triple with a constraint of its own if it has one, or
/// up to four constraints. What a block has no unknown for is a row of the unit matrix, and zero in vectors.
class KktPlan {
 public:
  KktPlan() = default;
  /// `threes` triples of unknowns, then `constraints`; `couplings` are the places off the diagonal, in any
  /// order, each once or twice.
  KktPlan(std::uint32_t threes, std::uint32_t constraints,
          std::span<const std::pair<std::uint32_t, std::uint32_t>> couplings, Isa isa);

  std::uint32_t columns() const { return columns_; }
  /// Numbers that a vector has, those without an unknown included.
  std::uint32_t unknowns() const { return 4 * columns_; }
  /// Blocks that a matrix and then its factors take.
  std::size_t blocks() const { return columns_ + rows_.size(); }
  /// Where the entry of two unknowns is among the numbers of the blocks; of one with itself, the diagonal.
  std::uint32_t place(std::uint32_t a, std::uint32_t b) const;
  /// Zeros, with ones on the diagonal where no unknown stands, so that blocks have inverses.
  std::vector<simd::Block> empty_matrix() const;
  /// Where an unknown stands in vectors that are solved.
  std::uint32_t position(std::uint32_t unknown) const { return position_[unknown]; }

  /// A matrix becomes its factors. False if a pivot is zero or not finite.
  bool factor(std::span<simd::Block> blocks) const;
  void solve(std::span<const simd::Block> factors, std::span<simd::Quad> x) const;
  /// For KktKernels.
  simd::KktPattern pattern() const { return {columns_, start_.data(), rows_.data()}; }

 private:
  std::uint32_t block(std::uint32_t column, std::uint32_t row) const;

  const simd::KktKernels* kernels_ = nullptr;
  std::uint32_t columns_ = 0;
  std::vector<std::uint32_t> position_;
  std::vector<std::uint32_t> padding_;  ///< positions without an unknown
  std::vector<std::uint32_t> start_;    ///< of every column's blocks below the diagonal, by elimination
  std::vector<std::uint32_t> rows_;     ///< their rows, by elimination, ascending
  std::vector<std::uint32_t> targets_;  ///< blocks that factor() updates, in its order
};

}  // namespace plumb::detail
