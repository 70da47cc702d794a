#pragma once

#include <algorithm>
#include <array>
#include <cmath>

#include "plumb/vec3.hpp"

/// This file describes places by their weights on four points.
namespace plumb::detail {

/// Returns six times the volume of the tetrahedron, in m³. Its mirror image has that with the other sign.
inline double signed_volume(const std::array<Vec3, 4>& p) {
  return dot(p[1] - p[0], cross(p[2] - p[0], p[3] - p[0]));
}

/// Returns the size of that, relative to its longest edge cubed. It is 0 if all points
/// are in one place.
inline double relative_volume(const std::array<Vec3, 4>& p) {
  double longest = 0;
  for (std::size_t i = 0; i < 4; ++i)
    for (std::size_t j = 0; j < i; ++j) longest = std::max(longest, norm(p[i] - p[j]));
  return longest > 0 ? std::abs(signed_volume(p)) / (longest * longest * longest) : 0;
}

/// Returns the sum of four vectors, each times its weight.
inline Vec3 weighted(const std::array<double, 4>& weights, const std::array<Vec3, 4>& vectors) {
  Vec3 out{};
  for (std::size_t i = 0; i < 4; ++i) out += weights[i] * vectors[i];
  return out;
}

/// Gives the weights of a place on four points that do not lie in one plane. They are linear in the place.
class Barycentric {
 public:
  explicit Barycentric(const std::array<Vec3, 4>& p) : origin_(p[0]) {
    const Vec3 u = p[1] - p[0], v = p[2] - p[0], w = p[3] - p[0];
    const double over = 1 / dot(u, cross(v, w));
    gradient_ = {Vec3{}, over * cross(v, w), over * cross(w, u), over * cross(u, v)};
    gradient_[0] -= gradient_[1] + gradient_[2] + gradient_[3];
  }

  /// Returns the gradients of the four weights, in 1/m.
  const std::array<Vec3, 4>& gradients() const { return gradient_; }
  std::array<double, 4> weights(Vec3 place) const {
    std::array<double, 4> out{1};
    for (std::size_t i = 1; i < 4; ++i) {
      out[i] = dot(gradient_[i], place - origin_);
      out[0] -= out[i];
    }
    return out;
  }

 private:
  Vec3 origin_;
  std::array<Vec3, 4> gradient_{};
};

}  // namespace plumb::detail
