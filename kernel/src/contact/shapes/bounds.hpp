#pragma once

#include <algorithm>
#include <cmath>

#include "plumb/vec3.hpp"

namespace plumb::detail {

/// This is a box along the axes of space.
struct Bounds {
  Vec3 low{}, high{};

  bool is_empty() const { return !(low.x <= high.x); }
  bool overlaps(const Bounds& o) const {
    return low.x <= o.high.x && o.low.x <= high.x && low.y <= o.high.y && o.low.y <= high.y &&
           low.z <= o.high.z && o.low.z <= high.z;
  }
  bool contains(const Bounds& o) const {
    return low.x <= o.low.x && o.high.x <= high.x && low.y <= o.low.y && o.high.y <= high.y &&
           low.z <= o.low.z && o.high.z <= high.z;
  }
};

inline constexpr Bounds nowhere{{INFINITY, INFINITY, INFINITY}, {-INFINITY, -INFINITY, -INFINITY}};

/// Makes a box large enough for a ball.
inline void include(Bounds& bounds, Vec3 p, double radius) {
  bounds.low = {std::min(bounds.low.x, p.x - radius), std::min(bounds.low.y, p.y - radius),
                std::min(bounds.low.z, p.z - radius)};
  bounds.high = {std::max(bounds.high.x, p.x + radius), std::max(bounds.high.y, p.y + radius),
                 std::max(bounds.high.z, p.z + radius)};
}

/// Returns how far apart two boxes are along the axis that separates them most. If negative, they overlap.
inline double distance(const Bounds& a, const Bounds& b) {
  return std::max({a.low.x - b.high.x, b.low.x - a.high.x, a.low.y - b.high.y, b.low.y - a.high.y,
                   a.low.z - b.high.z, b.low.z - a.high.z});
}

/// Returns the square of a point's distance (m²) from a box.
inline double distance2(const Bounds& box, Vec3 p) {
  const Vec3 out{std::max({box.low.x - p.x, 0.0, p.x - box.high.x}),
                 std::max({box.low.y - p.y, 0.0, p.y - box.high.y}),
                 std::max({box.low.z - p.z, 0.0, p.z - box.high.z})};
  return dot(out, out);
}

/// Returns how far (m) a box goes along a unit vector until it meets another one: infinite if it never does.
/// Rounding may make it a little shorter, but no longer.
inline double way_to(const Bounds& box, const Bounds& start, Vec3 along) {
  double first = 0, last = INFINITY;
  const auto cut = [&](double low, double high, double by) {
    const double wider = 1e-14 * (std::abs(low) + std::abs(high));
    const double enters = (by < 0 ? high + wider : low - wider) / by;
    const double leaves = (by < 0 ? low - wider : high + wider) / by;
    if (by != 0) {
      first = std::max(first, enters);
      last = std::min(last, leaves);
    } else if (low > wider || high < -wider) {
      first = INFINITY;
    }
  };
  cut(box.low.x - start.high.x, box.high.x - start.low.x, along.x);
  cut(box.low.y - start.high.y, box.high.y - start.low.y, along.y);
  cut(box.low.z - start.high.z, box.high.z - start.low.z, along.z);
  return first <= last + 1e-14 * std::abs(last) ? (1 - 1e-14) * first : INFINITY;
}

template <class Archive>
void visit_members(Archive& archive, Bounds& of) {
  auto& [low, high] = of;
  archive(low, high);
}

}  // namespace plumb::detail
