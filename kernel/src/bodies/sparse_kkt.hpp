#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <utility>
#include <vector>

#include "kkt_kernels.hpp"

namespace plumb::detail {

/// The plan of factors L D Lᵀ of symmetric matrices of one pattern,
///   [M Jᵀ; J -e],
/// M positive definite, e tiny: quasi-definite, so that every order of elimination has factors without
/// pivoting (Vanderbei 1995). A rod with inertia 0 on particles without mass has a singular M, and factor()
/// fails. The first unknowns are those of M in threes, the others constraints. Small
/// matrices with few neighbours: one flat list of places to update, no fronts.
class KktPlan {
 public:
  KktPlan() = default;
  /// `threes` triples of unknowns, then `constraints`; `couplings` are the places off the diagonal, in any
  /// order, each once or twice.
  KktPlan(std::uint32_t threes, std::uint32_t constraints,
          std::span<const std::pair<std::uint32_t, std::uint32_t>> couplings);

  std::uint32_t unknowns() const { return static_cast<std::uint32_t>(order_.size()); }
  /// Numbers that a matrix and then its factors take.
  std::size_t values() const { return rows_.size() + order_.size(); }
  /// Where the entry of two unknowns is among the values; of one with itself, the diagonal.
  std::uint32_t place(std::uint32_t a, std::uint32_t b) const;
  /// Where an unknown stands in vectors that are solved.
  std::uint32_t position(std::uint32_t unknown) const { return position_[unknown]; }

  /// A matrix becomes its factors. False if a pivot is zero or not finite.
  bool factor(std::span<double> values) const;
  void solve(std::span<const double> factors, std::span<double> x) const;
  /// For KktKernels, of right hand sides side by side.
  simd::KktView view(std::span<const double> factors) const;

 private:
  std::vector<std::uint32_t> order_, position_;
  std::vector<std::uint32_t> start_;    ///< of every column's entries below the diagonal, by elimination
  std::vector<std::uint32_t> rows_;     ///< their rows, by elimination, ascending
  std::vector<std::uint32_t> targets_;  ///< values that factor() updates, in its order
};

}  // namespace plumb::detail
