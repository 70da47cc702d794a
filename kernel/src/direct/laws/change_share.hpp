#pragma once

#include <algorithm>

namespace plumb::detail {

/// Says which share of Newton's changes is made where rods give. Cables may go to and fro between slack and
/// taut, and then changes do not fall. Half of one is made, and half of that if need be.
class ChangeShare {
 public:
  /// Returns the share of the next change, which is `rate` of the last one. It is 1 where changes converge,
  /// and in the first iterations, which sort cables out.
  double next(double rate) {
    if (++changes_ <= settling) return share_;
    share_ = rate > slow_rate ? std::max(share_ / 2, least) : std::min(2 * share_, 1.0);
    return share_;
  }

 private:
  static constexpr int settling = 4;
  static constexpr double slow_rate = 0.7, least = 1.0 / 16;

  int changes_ = 0;
  double share_ = 1;
};

}  // namespace plumb::detail
