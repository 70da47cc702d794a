#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>

#include "plumb/vec3.hpp"

/// This file finds where rounded shapes come nearest: the closest points of lines and of boxes.
namespace plumb::detail {

/// Says how near two shapes are to touching. `a` and `b` are places along the lines of the pair, from 0 to 1.
struct Touch {
  double gap = 0;  ///< distance between the surfaces in m; if negative, their overlap
  Vec3 normal{};   ///< unit vector from b's shape to a's
  double a = 0, b = 0;
};

/// This is a line from p to q (m) with a radius (m): the middle of a capsule.
struct Segment {
  Vec3 p, q;
  double radius;
};

inline Vec3 between(Vec3 p, Vec3 q, double t) {
  return p + t * (q - p);
}

/// Finds where two segments are nearest (Ericson 2005, section 5.1.9). The nearest points of the unbounded
/// lines are pulled into the segments one after the other.
inline Touch touch(const Segment& a, const Segment& b) {
  const Vec3 u = a.q - a.p, v = b.q - b.p, r = a.p - b.p;
  const double uu = dot(u, u), vv = dot(v, v), uv = dot(u, v), ur = dot(u, r), vr = dot(v, r);
  const double least = 1e-24;
  double s = 0, t = 0;
  const double area = uu * vv - uv * uv;
  if (uu > least && vv > least && area > 1e-12 * uu * vv)
    s = std::clamp((uv * vr - vv * ur) / area, 0.0, 1.0);
  else if (uu > least && vv > least)
    s = 0.5;  // the segments are parallel, so that any place will do
  if (vv > least) t = std::clamp((uv * s + vr) / vv, 0.0, 1.0);
  if (uu > least) s = std::clamp((uv * t - ur) / uu, 0.0, 1.0);
  const Vec3 apart = between(a.p, a.q, s) - between(b.p, b.q, t);
  const double distance = norm(apart);
  const Vec3 normal = distance > 1e-12 ? (1 / distance) * apart : Vec3{0, 1, 0};
  return {distance - a.radius - b.radius, normal, s, t};
}

/// Returns whether a plane across an axis or across the line between middles parts two segments' surfaces by
/// more than `reach` (m).
inline bool are_apart(const Segment& a, const Segment& b, double reach) {
  const Vec3 own = a.q - a.p, other = b.q - b.p, twice = (a.p + a.q) - (b.p + b.q);
  const double most = reach + a.radius + b.radius;
  const auto parts = [&](double apart, double one, double two) {
    return std::abs(apart) - std::abs(one) - std::abs(two) > 2 * most;
  };
  return parts(twice.x, own.x, other.x) || parts(twice.y, own.y, other.y) || parts(twice.z, own.z, other.z) ||
         dot(twice, twice) - std::abs(dot(twice, own)) - std::abs(dot(twice, other)) > 2 * most * norm(twice);
}

/// Lists where two segments are to be kept apart. They are kept apart where they are nearest. Segments that
/// lie along each other are also kept apart at the ends of their common part. `count` entries of `at` are
/// set, none if the gap is wider than `reach` (m).
struct Touches {
  Touch at[3];
  std::uint32_t count = 0;
};
inline Touches touches(const Segment& a, const Segment& b, double reach = INFINITY) {
  Touches out;
  out.at[0] = touch(a, b);
  if (out.at[0].gap > reach) return out;
  out.count = 1;
  const Vec3 u = a.q - a.p, v = b.q - b.p;
  const double uu = dot(u, u), vv = dot(v, v), uv = dot(u, v);
  constexpr double along =
      0.97;  // squared cosine of 10 degrees; a smaller value takes more pairs as lying along each other
  if (uu == 0 || vv == 0 || uv * uv < along * uu * vv) return out;
  const double first = std::clamp(dot(b.p - a.p, u) / uu, 0.0, 1.0);
  const double second = std::clamp(dot(b.q - a.p, u) / uu, 0.0, 1.0);
  for (const double s : {first, second}) {
    const Vec3 p = between(a.p, a.q, s);
    Touch end = touch({p, p, a.radius}, b);
    end.a = s;
    if (std::abs(first - second) > 1e-3 && std::abs(s - out.at[0].a) > 1e-3) out.at[out.count++] = end;
  }
  return out;
}

/// Holds three unit vectors at right angles.
struct Frame3 {
  Vec3 x{1, 0, 0}, y{0, 1, 0}, z{0, 0, 1};

  Vec3 to_local(Vec3 v) const { return {dot(x, v), dot(y, v), dot(z, v)}; }
  Vec3 to_space(Vec3 v) const { return v.x * x + v.y * y + v.z * z; }
};

/// Finds how near a ball is to a box about the origin, in the box's axes (m). The normal points to the ball.
inline Touch touch_box(Vec3 center, double radius, Vec3 half) {
  const Vec3 nearest{std::clamp(center.x, -half.x, half.x), std::clamp(center.y, -half.y, half.y),
                     std::clamp(center.z, -half.z, half.z)};
  const Vec3 apart = center - nearest;
  const double distance = norm(apart);
  if (distance > 1e-12) return {distance - radius, (1 / distance) * apart, 0, 0};
  // The centre is inside the box, so that the way out leads through the nearest face.
  const double x = half.x - std::abs(center.x), y = half.y - std::abs(center.y),
               z = half.z - std::abs(center.z);
  if (x <= y && x <= z) return {-x - radius, {std::copysign(1, center.x), 0, 0}, 0, 0};
  if (y <= z) return {-y - radius, {0, std::copysign(1, center.y), 0}, 0, 0};
  return {-z - radius, {0, 0, std::copysign(1, center.z)}, 0, 0};
}

/// Returns the place on a segment, from 0 to 1, where its distance to a box is least. The distance is convex
/// along the segment, and golden section finds its minimum to 1e-8 in 40 cuts.
inline double nearest_to_box(Vec3 p, Vec3 q, Vec3 half) {
  const auto distance2 = [&](double t) {
    const Vec3 c = between(p, q, t);
    const Vec3 out{std::max(std::abs(c.x) - half.x, 0.0), std::max(std::abs(c.y) - half.y, 0.0),
                   std::max(std::abs(c.z) - half.z, 0.0)};
    return dot(out, out);
  };
  constexpr double golden = 0.6180339887498949;
  double low = 0, high = 1, left = 1 - golden, right = golden;
  double at_left = distance2(left), at_right = distance2(right);
  for (int i = 0; i < 40; ++i) {
    if (at_left <= at_right) {
      high = right, right = left, at_right = at_left;
      left = high - golden * (high - low), at_left = distance2(left);
    } else {
      low = left, left = right, at_left = at_right;
      right = low + golden * (high - low), at_right = distance2(right);
    }
  }
  return (low + high) / 2;
}

/// Returns where a segment is to be kept off a box; places outside 0 to 1 do not count. These are its nearest
/// point, its ends, and the places where it passes over the edges of a face. The last matter where it lies
/// flat on the face.
inline std::array<double, 9> touching_box(Vec3 p, Vec3 q, Vec3 half, double nearest) {
  const Vec3 along = q - p;
  const auto pass = [](double from, double by, double edge) { return by == 0 ? -1 : (edge - from) / by; };
  return {nearest,
          0,
          1,
          pass(p.x, along.x, -half.x),
          pass(p.x, along.x, half.x),
          pass(p.y, along.y, -half.y),
          pass(p.y, along.y, half.y),
          pass(p.z, along.z, -half.z),
          pass(p.z, along.z, half.z)};
}

}  // namespace plumb::detail
