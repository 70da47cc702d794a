#include "plumb/key_frames.hpp"

#include <algorithm>
#include <cmath>
#include <utility>
#include <vector>

#include "scene/refuse.hpp"

namespace plumb {

using detail::refuse;

KeyFrames::KeyFrames(std::vector<KeyFrame> frames) : frames_(std::move(frames)) {
  if (frames_.empty()) refuse("key frames: there are none");
  for (std::size_t i = 0; i < frames_.size(); ++i) {
    const auto& [time, pose] = frames_[i];
    if (!std::isfinite(time)) refuse("key frame ", i, ": time is not finite: ", time);
    if (i > 0 && !(time > frames_[i - 1].time))
      refuse("key frame ", i, ": time must be after that of the one before, got ", time, " s");
    if (pose.size() != frames_[0].pose.size())
      refuse("key frame ", i, ": has ", pose.size(), " targets, the first has ", frames_[0].pose.size());
    for (const double target : pose)
      if (!std::isfinite(target)) refuse("key frame ", i, ": a target is not finite: ", target);
  }
}

std::size_t KeyFrames::pose_size() const {
  return frames_.front().pose.size();
}
double KeyFrames::first_time() const {
  return frames_.front().time;
}
double KeyFrames::last_time() const {
  return frames_.back().time;
}

void KeyFrames::pose_at(double time, std::span<double> out) const {
  if (out.size() != pose_size())
    refuse("a pose of ", pose_size(), " targets does not fit ", out.size(), " elements");
  if (!std::isfinite(time)) refuse("time is not finite: ", time);
  const auto next = std::upper_bound(frames_.begin(), frames_.end(), time,
                                     [](double t, const KeyFrame& frame) { return t < frame.time; });
  const auto i = static_cast<std::size_t>(next - frames_.begin());
  if (i == 0 || i == frames_.size()) {
    const KeyFrame& end = i == 0 ? frames_.front() : frames_.back();
    std::copy(end.pose.begin(), end.pose.end(), out.begin());
    return;
  }
  const double from = frames_[i - 1].time, lasts = frames_[i].time - from, s = (time - from) / lasts;
  // The rate at a pose is that between its neighbours. The first and the last are at rest.
  const auto rate = [&](std::size_t at, std::size_t k) {
    if (at == 0 || at + 1 == frames_.size()) return 0.0;
    return (frames_[at + 1].pose[k] - frames_[at - 1].pose[k]) /
           (frames_[at + 1].time - frames_[at - 1].time);
  };
  const double back = 1 - s, toward = s * s * (3 - 2 * s);
  for (std::size_t k = 0; k < out.size(); ++k) {
    const double a = frames_[i - 1].pose[k], b = frames_[i].pose[k];
    out[k] = a + toward * (b - a) + lasts * s * back * (back * rate(i - 1, k) - s * rate(i, k));
  }
}

void blend_poses(std::span<const double> first, std::span<const double> second, double share,
                 std::span<double> out) {
  if (first.size() != out.size() || second.size() != out.size())
    refuse("poses of ", first.size(), " and ", second.size(), " targets do not blend into ", out.size());
  if (std::isnan(share)) refuse("the share of a blend is not a number");
  const double s = std::clamp(share, 0.0, 1.0), eased = s * s * (3 - 2 * s);
  for (std::size_t k = 0; k < out.size(); ++k) out[k] = first[k] + eased * (second[k] - first[k]);
}

}  // namespace plumb
