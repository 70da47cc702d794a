#pragma once

#include <array>
#include <cstdint>

#include "contact/platforms/ground_rate.hpp"
#include "contact/shapes/touch.hpp"
#include "plumb/layouts/memory.hpp"
#include "plumb/scene.hpp"

namespace plumb::detail {

using Quaternion = std::array<double, 4>;  ///< w, x, y, z
/// Returns the rotation by `b` and then by `a`.
Quaternion product(const Quaternion& a, const Quaternion& b);
Quaternion conjugate(const Quaternion& q);
/// Returns the rotation by |turn| (rad) about `turn`, as a unit quaternion w, x, y, z.
std::array<double, 4> rotation(Vec3 turn);
/// Returns the shortest turn (rad, about a vector) that leads from one unit quaternion to another.
Vec3 turn_between(const std::array<double, 4>& from, const std::array<double, 4>& to);
/// Returns the axes of a unit quaternion.
Frame3 frame_of(const std::array<double, 4>& quaternion);

/// Says where a platform is at an instant, and how fast it moves. It takes places of the scene there.
struct PlatformPose {
  bool is_home = true;  ///< it has the pose of the scene, where all places stay bit for bit
  Vec3 from{};          ///< m, its origin in the scene
  Frame3 turned{};      ///< what became of the axes of space
  GroundRate rate{};    ///< its centre is the platform's origin

  Vec3 direction(Vec3 v) const { return is_home ? v : turned.to_space(v); }
  Vec3 place(Vec3 x) const { return is_home ? x : rate.center + turned.to_space(x - from); }
  bool moves() const { return rate.velocity != Vec3{} || rate.spin != Vec3{}; }
};

/// Knows where platforms are, and where they go in a step.
class Platforms {
 public:
  explicit Platforms(const Scene& scene);

  std::uint32_t count() const { return static_cast<std::uint32_t>(paths_.size()); }
  /// Lets a platform move to `target` within the next step.
  void set_target(std::uint32_t number, const Pose& target);
  /// Begins a step of dt (s), and ends it.
  void begin_step(double dt);
  void end_step();
  /// Returns whether some platform moves in this step.
  bool any_moves() const;
  template <class Archive>
  void archive(Archive& archive) {
    for (Path& path : paths_) {
      auto& [home, now, target, velocity, spin] = path;
      archive(now, target, velocity, spin);
    }
  }
  /// Returns where a platform is `t` (s) after the step's start.
  PlatformPose at(std::uint32_t number, double t) const;

 private:
  struct Path {
    Pose home, now, target;
    Vec3 velocity{}, spin{};  ///< m/s and 1/s, in this step
  };
  Array<Path> paths_;
};

template <class Archive>
void visit_members(Archive& archive, Pose& of) {
  auto& [position, orientation] = of;
  archive(position, orientation);
}

}  // namespace plumb::detail
