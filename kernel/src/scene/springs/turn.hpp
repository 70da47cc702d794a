#pragma once

#include <algorithm>
#include <cmath>
#include <numbers>

#include "math/elementary.hpp"
#include "plumb/vec3.hpp"

namespace plumb::detail {

/// Returns the angle in (-pi, pi] rad of the vector (x, y) from the first axis; 0 of none.
inline double angle_of(double x, double y) {
  constexpr double pi = std::numbers::pi;
  const double length = std::sqrt(x * x + y * y);
  if (!(length > 0)) return 0;
  const double cosine = std::clamp(x / length, -1.0, 1.0), sine = std::clamp(y / length, -1.0, 1.0);
  // The cosine tells an angle well only away from 0 and pi, and there the sine does.
  if (std::abs(cosine) < 0.7) return y < 0 ? -acos(cosine) : acos(cosine);
  const double up = pi / 2 - acos(sine);
  return x > 0 ? up : y < 0 ? -pi - up : pi - up;
}

/// Two directions, seen along an axis.
struct Across {
  Vec3 axis, u, v;                  ///< The axis has length 1 or 0, the others are across it, in m.
  double over_axis = 0;             ///< 1/m
  double u_along = 0, v_along = 0;  ///< m

  Across(Vec3 whole_axis, Vec3 whole_u, Vec3 whole_v) {
    const double length = norm(whole_axis);
    over_axis = length > 0 ? 1 / length : 0;
    axis = over_axis * whole_axis;
    u_along = dot(whole_u, axis);
    v_along = dot(whole_v, axis);
    u = whole_u - u_along * axis;
    v = whole_v - v_along * axis;
  }
  /// Returns the angle from u to v in (-pi, pi] rad.
  double turn() const { return angle_of(dot(u, v), dot(axis, cross(u, v))); }
  /// Returns that angle, of all turns the one nearest to `near` (rad).
  double turn_near(double near) const {
    constexpr double whole = 2 * std::numbers::pi;
    const double turned = turn();
    return turned + whole * std::round((near - turned) / whole);
  }
};

}  // namespace plumb::detail
