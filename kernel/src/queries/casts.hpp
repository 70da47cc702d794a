#pragma once

#include <cmath>

#include "queries/near_things.hpp"
#include "queries/probe.hpp"
#include "queries/things.hpp"

/// This file says where what is cast meets things first. What it finds depends on the two alone, and on
/// nothing that was found before.
namespace plumb::detail {

/// Returns how far (m) a place goes along a unit vector until it is within `radius` (m) of the line from p to
/// q: 0 if it starts there, infinite if it never is.
///
/// All numbers are taken where the way is nearest to the middle of the line, so that rounding is that of the
/// shape's size. It is the place where the way enters the endless cylinder, or the ball at the end on that
/// side.
inline double way_to_capsule(Vec3 origin, Vec3 direction, Vec3 p, Vec3 q, double radius) {
  const Vec3 axis = q - p;
  const double shift = dot(p + 0.5 * axis - origin, direction);
  const Vec3 from = origin + shift * direction - p, around = cross(axis, direction);
  const double square = dot(axis, axis), steep = dot(around, around), along = dot(axis, direction);
  bool at_q = along < 0;
  double way = INFINITY;
  if (steep > 1e-20 * square) {  // not parallel
    const Vec3 arm = cross(axis, from);
    const double miss = dot(axis, cross(around, arm));
    const double room = steep * radius * radius * square - miss * miss / square;
    if (room < 0) return INFINITY;
    const double t = (-dot(around, arm) - std::sqrt(room)) / steep, at = dot(from, axis) + t * along;
    if (at >= 0 && at <= square) way = shift + t;
    at_q = at > square;
  }
  if (way == INFINITY) {
    const Vec3 arm = at_q ? origin + shift * direction - q : from;
    const double b = dot(arm, direction);
    const Vec3 miss = arm - b * direction;
    const double room = radius * radius - dot(miss, miss);
    if (room < 0) return INFINITY;
    way = shift - b - std::sqrt(room);
  }
  if (way >= 0) return way;
  return near_capsule(origin, p, q, radius).distance <= 0 ? 0 : INFINITY;
}

/// Says where a probe meets something within its length.
Strike cast(const Probe& probe, const PlaneNow& plane);
Strike cast(const Probe& probe, const Convex& shape);
Strike cast(const Probe& probe, const TriangleMesh& mesh);

/// Says where a point or a ball touches a capsule, which it does at a distance (m).
Strike strike_on_capsule(const Probe& probe, const Thing& capsule, double distance);

}  // namespace plumb::detail
