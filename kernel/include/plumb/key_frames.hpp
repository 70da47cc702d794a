#pragma once

#include <cstddef>
#include <span>
#include <vector>

#include "plumb/export.hpp"

namespace plumb {

/// This is a pose at an instant: the targets of drives, in an order of the program's own.
struct KeyFrame {
  double time = 0;           ///< Time, in s.
  std::vector<double> pose;  ///< Targets, in rad, such as those of AngleControl::target or Torsion::angle.
};

/// Leads from pose to pose on cubic curves (Catmull, Rom 1974) without jumps of rates, from rest to rest.
///
/// A program reads the pose of a step's middle, World::time() + dt/2, and hands it to World::set_angle() or
/// set_torsion() before that step. Drives seek it as far as their stiffness, loads and contacts let them.
class PLUMB_API KeyFrames {
 public:
  /// Takes poses in the order of time. Throws InputError unless there is one at least, all are of one size,
  /// times ascend, and all numbers are finite.
  explicit KeyFrames(std::vector<KeyFrame> frames);

  std::size_t pose_size() const;  ///< Targets of a pose.
  double first_time() const;      ///< Time of the first pose, in s.
  double last_time() const;       ///< Time of the last pose, in s.
  /// Writes the pose at `time` (s) to `out`, in rad. Before the first and after the last one it is theirs.
  /// Throws InputError unless `out` has pose_size() elements and the time is finite.
  void pose_at(double time, std::span<double> out) const;

 private:
  std::vector<KeyFrame> frames_;
};

/// Blends two poses (rad) into `out`, which may be one of them. A `share` of 0 or less is the first, of 1 or
/// more the second, and between them the blend starts and ends at rest: 3 share² - 2 share³. Throws
/// InputError unless all three are of one size and the share is a number.
PLUMB_API void blend_poses(std::span<const double> first, std::span<const double> second, double share,
                           std::span<double> out);

}  // namespace plumb
