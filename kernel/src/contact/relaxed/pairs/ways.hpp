#pragma once

#include <algorithm>

#include "contact/linkage/linkage.hpp"
#include "contact/shapes/bounds.hpp"

/// This file says how boxes are made around the ways of what may touch, and in which order pairs are listed.
namespace plumb::detail {

/// A place may go this much farther in a step than it would at its velocity, because something pushes it.
inline constexpr double further = 1.25;

inline Bounds passed_through(Vec3 from, Vec3 by, double radius) {
  Bounds out = nowhere;
  include(out, from, radius);
  include(out, from + further * by, radius);
  return out;
}

inline void include(Bounds& bounds, const Bounds& other) {
  include(bounds, other.low, 0);
  include(bounds, other.high, 0);
}

/// Returns how far (m) something falls in dt (s).
inline double fall_in(const Linkage& linkage, double dt) {
  return 0.5 * dt * dt * norm(linkage.gravity());
}

inline Bounds moved_by(const Bounds& bounds, Vec3 by) {
  return {bounds.low + by, bounds.high + by};
}

/// Orders pairs by their first, then by their second number.
inline constexpr auto is_before = [](const auto& a, const auto& b) {
  return a.one != b.one ? a.one < b.one : a.other < b.other;
};

/// Orders pairs by their second, then by their first number.
inline constexpr auto is_before_by_ground = [](const auto& a, const auto& b) {
  return a.other != b.other ? a.other < b.other : a.one < b.one;
};

}  // namespace plumb::detail
