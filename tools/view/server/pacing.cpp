#include "view/server/pacing.hpp"

#include <algorithm>

namespace plumb::view {

Pacing::Pacing(double length_of_frame, double speed, Time now)
    : frame_length_(length_of_frame), speed_(speed) {
  start(now);
}

void Pacing::start(Time now) {
  last_ = now;
  due_ = now + period();
  simulated_ = passed_ = 0;
}

void Pacing::set_speed(double speed, Time now) {
  speed_ = speed;
  start(now);
}

void Pacing::count(Time now) {
  constexpr double fades = 0.98;  // a frame; half of a sum is from the last 34
  simulated_ = fades * simulated_ + frame_length_;
  passed_ = fades * passed_ + std::chrono::duration<double>(now - last_).count();
  last_ = now;
  due_ = std::max(due_ + period(), now - period());
}

std::chrono::steady_clock::duration Pacing::period() const {
  return std::chrono::duration_cast<std::chrono::steady_clock::duration>(
      std::chrono::duration<double>(frame_length_ / speed_));
}

}  // namespace plumb::view
