#pragma once

#include <algorithm>
#include <limits>

namespace plumb::detail {

/// Says whether an iteration gets anywhere. Changes may rise, since the first ones sort out what pulls and
/// what is slack. What has not halved the least change within a few iterations goes round in circles.
class Progress {
 public:
  explicit Progress(int patience = 1) : patience_(patience) {}

  /// Takes note of a change. Returns whether to go on.
  bool goes_on(double change) {
    if (change <= enough * least_) {
      least_ = change;
      since_ = 0;
    }
    return ++since_ <= patience_;
  }

 private:
  static constexpr double enough = 0.5;

  double least_ = std::numeric_limits<double>::infinity();
  int patience_, since_ = 0;
};

}  // namespace plumb::detail
