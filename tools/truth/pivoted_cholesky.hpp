#pragma once

#include <cstdint>
#include <vector>

#include "truth/real.hpp"

namespace plumb::truth {

/// Factors a positive semidefinite matrix as L Lᵀ, taking the greatest remaining diagonal element as the next
/// pivot. It reveals the rank: once no pivot is above rounding, the rows that are left depend on the others.
/// The source is Higham, Accuracy and Stability of Numerical Algorithms, section 10.3.
class PivotedCholesky {
 public:
  /// Factors `full`, which is k×k by rows. Row and column i are measured in units of sqrt(unit[i]). A pivot
  /// below `least` of its unit counts as rounding. It costs O(k³/3).
  void factor(const std::vector<Real>& full, const std::vector<Real>& unit, Real least);

  /// Solves in place. The result is 0 for the rows left out, whose right-hand sides are not read. It costs
  /// O(k²).
  void solve(std::vector<Real>& r) const;

  /// Returns the number of rows left out.
  const std::vector<std::uint32_t>& dependent() const { return dependent_; }

 private:
  std::vector<std::vector<Real>> lower_;  ///< Factor L, whose row i belongs to pivots_[i].
  std::vector<std::uint32_t> pivots_;
  std::vector<std::uint32_t> dependent_;
};

}  // namespace plumb::truth
