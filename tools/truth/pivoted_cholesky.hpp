#pragma once

#include <cstdint>
#include <vector>

#include "truth/real.hpp"

namespace plumb::truth {

/// L Lᵀ of a positive semidefinite matrix, the greatest remaining diagonal element being the next pivot. It
/// reveals the rank: once no pivot is above rounding, the rows that are left depend on the others
/// (Higham, Accuracy and Stability of Numerical Algorithms, section 10.3).
class PivotedCholesky {
 public:
  /// `full` is k×k by rows; row and column i are measured in units of sqrt(unit[i]). A pivot below `least`
  /// of its unit counts as rounding. O(k³/3).
  void factor(const std::vector<Real>& full, const std::vector<Real>& unit, Real least);

  /// In place; 0 for the rows left out, whose right-hand sides are not read. O(k²).
  void solve(std::vector<Real>& r) const;

  /// The rows left out.
  const std::vector<std::uint32_t>& dependent() const { return dependent_; }

 private:
  std::vector<std::vector<Real>> lower_;  ///< row i belongs to pivots_[i]
  std::vector<std::uint32_t> pivots_;
  std::vector<std::uint32_t> dependent_;
};

}  // namespace plumb::truth
