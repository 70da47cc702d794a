#include "contact/platforms/platforms.hpp"

#include <algorithm>
#include <cmath>

#include "math/elementary.hpp"
#include "plumb/joints.hpp"

namespace plumb::detail {

Quaternion product(const Quaternion& a, const Quaternion& b) {
  const Vec3 u{a[1], a[2], a[3]}, v{b[1], b[2], b[3]};
  const Vec3 w = a[0] * v + b[0] * u + cross(u, v);
  return {a[0] * b[0] - dot(u, v), w.x, w.y, w.z};
}

Quaternion conjugate(const Quaternion& q) {
  return {q[0], -q[1], -q[2], -q[3]};
}

namespace {

/// Returns arcsin(s)/s for 0 <= s <= 0.02, to rounding: the next term of the series is below 1e-16.
double over_small_sine(double s) {
  const double s2 = s * s;
  return 1 + s2 * (1.0 / 6 + s2 * (3.0 / 40 + s2 * (15.0 / 336)));
}

}  // namespace

Quaternion rotation(Vec3 turn) {
  // Sine and cosine of the half angle follow from those of a small part of it, which is doubled again.
  constexpr int doublings = 6;
  const double angle = norm(turn), part = angle / (2 << doublings), x2 = part * part;
  double sine = part * (1 - x2 / 6 * (1 - x2 / 20 * (1 - x2 / 42 * (1 - x2 / 72))));
  double versine = x2 / 2 * (1 - x2 / 12 * (1 - x2 / 30 * (1 - x2 / 56)));  // 1 - cosine
  for (int i = 0; i < doublings; ++i) {
    const double doubled = 2 * sine * (1 - versine);
    versine = 2 * sine * sine;
    sine = doubled;
  }
  const double over = angle > 0 ? sine / angle : 0;
  return {1 - versine, over * turn.x, over * turn.y, over * turn.z};
}

Vec3 turn_between(const Quaternion& from, const Quaternion& to) {
  Quaternion by = product(to, conjugate(from));
  if (by[0] < 0)
    for (double& each : by) each = -each;
  const Vec3 sines{by[1], by[2], by[3]};
  const double sine = norm(sines);
  if (sine <= 0.02) return 2 * over_small_sine(sine) * sines;
  return (2 * detail::acos(std::fmin(by[0], 1)) / sine) * sines;
}

Frame3 frame_of(const Quaternion& quaternion) {
  const std::array<Vec3, 3> axes = axes_of(quaternion);
  return {axes[0], axes[1], axes[2]};
}

Vec3 GroundRate::moved(Vec3 place, Vec3 normal, double h) const {
  const Vec3 even = h * at(place, normal);
  if (spin == Vec3{}) return even;
  const Vec3 arm = place - center;
  const Vec3 bent = frame_of(rotation(h * spin)).to_space(arm) - arm - h * cross(spin, arm);
  return even + bent - dot(bent, normal) * normal;
}

Platforms::Platforms(const Scene& scene) {
  for (const Pose& pose : scene.platforms) paths_.push_back({pose, pose, pose});
}

void Platforms::set_target(std::uint32_t number, const Pose& target) {
  paths_[number].target = target;
}

void Platforms::begin_step(double dt) {
  for (Path& path : paths_) {
    path.velocity = (1 / dt) * (path.target.position - path.now.position);
    path.spin = path.target.orientation == path.now.orientation
                    ? Vec3{}
                    : (1 / dt) * turn_between(path.now.orientation, path.target.orientation);
  }
}

void Platforms::end_step() {
  for (Path& path : paths_) {
    path.now = path.target;
    path.velocity = path.spin = {};
  }
}

bool Platforms::any_moves() const {
  return std::any_of(paths_.begin(), paths_.end(),
                     [](const Path& path) { return path.velocity != Vec3{} || path.spin != Vec3{}; });
}

PlatformPose Platforms::at(std::uint32_t number, double t) const {
  const Path& path = paths_[number];
  PlatformPose out{
      .from = path.home.position,
      .rate = {
          .center = path.now.position + t * path.velocity, .velocity = path.velocity, .spin = path.spin}};
  out.is_home = path.now == path.home && !out.moves();
  if (out.is_home) return out;
  const Quaternion there =
      path.spin == Vec3{} ? path.now.orientation : product(rotation(t * path.spin), path.now.orientation);
  if (there != path.home.orientation) out.turned = frame_of(product(there, conjugate(path.home.orientation)));
  return out;
}

}  // namespace plumb::detail
