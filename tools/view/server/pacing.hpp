#pragma once

#include <chrono>

namespace plumb::view {

/// Says when frames are due, so that simulated time keeps pace with a clock, and what pace was reached. It
/// reads no clock itself.
class Pacing {
 public:
  using Time = std::chrono::steady_clock::time_point;

  /// Frames of `length_of_frame` s follow each other from `now` on, at `speed` simulated seconds per second.
  Pacing(double length_of_frame, double speed, Time now);

  /// Goes on from `now`, as after a pause.
  void start(Time now);
  void set_speed(double speed, Time now);

  Time due() const { return due_; }
  bool is_due(Time now) const { return now >= due_; }
  /// A frame is done. Frames that come late by up to one are caught up with; what is lost beyond that is
  /// lost, and shows as a lower pace.
  void count(Time now);
  /// Returns simulated seconds per second, over the last second or so; 0 before the first frame.
  double reached() const { return passed_ > 0 ? simulated_ / passed_ : 0; }

 private:
  std::chrono::steady_clock::duration period() const;

  double frame_length_;
  double speed_;
  Time due_{};
  Time last_{};
  // Sums that fade. Their ratio is a pace; a mean of paces of single frames would be too high where frames
  // come unevenly.
  double simulated_ = 0, passed_ = 0;
};

}  // namespace plumb::view
