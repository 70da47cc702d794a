#pragma once

#include <algorithm>
#include <cmath>
#include <span>

#include "contact/linkage/linkage_state.hpp"

namespace plumb::detail {

inline void include(Bounds& bounds, Vec3 p, double radius) {
  bounds.low = {std::min(bounds.low.x, p.x - radius), std::min(bounds.low.y, p.y - radius),
                std::min(bounds.low.z, p.z - radius)};
  bounds.high = {std::max(bounds.high.x, p.x + radius), std::max(bounds.high.y, p.y + radius),
                 std::max(bounds.high.z, p.z + radius)};
}

inline constexpr Bounds nowhere{{INFINITY, INFINITY, INFINITY}, {-INFINITY, -INFINITY, -INFINITY}};

/// Returns a box around a linkage's shapes, with particles at x.
inline Bounds bounds_of(const Linkage& linkage, std::span<const Vec3> x, double further) {
  Bounds out = nowhere;
  for (const Linkage::Ball& ball : linkage.balls()) include(out, ball.center.of(x), ball.radius + further);
  return out;
}

/// Returns how far apart two boxes are along the axis that separates them most. If negative, they overlap.
inline double distance(const Bounds& a, const Bounds& b) {
  return std::max({a.low.x - b.high.x, b.low.x - a.high.x, a.low.y - b.high.y, b.low.y - a.high.y,
                   a.low.z - b.high.z, b.low.z - a.high.z});
}

}  // namespace plumb::detail
