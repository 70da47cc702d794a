#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <optional>

#include "contact/ground/placed_hulls.hpp"
#include "contact/linkage/linkage.hpp"
#include "contact/rows.hpp"
#include "contact/surroundings.hpp"
#include "scene/barycentric.hpp"

/// This file finds where what moves is to be kept off ground, whether contact is solved or relaxed.
///
/// What is near is kept off where it is near. What moves fast may pass by that, and is kept off the plane in
/// which it is touched first.
namespace plumb::detail {

/// A substep is solved or relaxed at most so often again because something went into ground unexpectedly.
inline constexpr int most_missed = 4;

/// Says how ground is looked for.
struct GroundSearch {
  double margin = 0;  ///< m, of contact
  double close = 0;   ///< m, what is nearer touches
  /// What moves by more than the margin and this share of its half width is fast.
  static constexpr double passes = 0.5;

  /// Returns whether something of a half width (m) that moves by `moves` may pass what it does not touch.
  bool is_fast(double moves, double half_width) const { return moves > margin + passes * half_width; }
  /// Returns how far (m) ground is looked for where something is.
  double reach(double moves, double half_width) const {
    return margin + passes * half_width + (is_fast(moves, half_width) ? 0 : 2 * moves);
  }
};

inline double moves_of(const MovingSegment& moving) {
  return std::max(norm(moving.p_by), norm(moving.q_by));
}

/// This is the end of a shape that has its middle elsewhere, and how far it moves (m).
struct MovingEnd {
  Vec3 at, middle;
  double radius, moves;
};

/// Returns the plane up to which a place on a moving line may go, if that is where it is touched first.
inline Touch plane_of(double time, Vec3 normal, double at, Vec3 by) {
  return {-time * dot(normal, by), normal, at, 0};
}

/// Calls add(near) where ground is near a point of a shape with its middle elsewhere, as far as `reach` (m).
/// What lies within one of many solids goes out through the nearest face that is none between two of them.
/// Where that is far, as in a corner between walls, it leaves all of them through those between them.
/// What lies a slop deep in a floor touches walls as it does where it comes out of that: it is below them.
template <class Add>
void for_point_touches(const Surroundings& around, std::uint32_t ground, const MovingEnd& end, double reach,
                       double close, Add&& add) {
  const GroundShape& shape = around.shapes[ground];
  if (distance2(shape.bounds(), end.at) > reach * reach) return;
  const Vec3 at = shape.is_convex() ? around.lifted(ground, end.at, close) : end.at;
  const auto add_at = [&](const Surroundings::Near& near) {
    add(Surroundings::Near{end.at, near.distance - dot(near.normal, at - end.at), near.normal});
  };
  LineTouches touches;
  shape.touch_point(at, end.middle, reach, touches);
  for (const LineTouch& each : touches) {
    const Surroundings::Near near{at, each.gap, each.normal};
    if (!shape.is_convex() || !around.is_covered(ground, near, close)) {
      add_at(near);
    } else if (each.gap <= close) {
      std::optional<Surroundings::Near> exit;
      shape.for_exits(at, [&](double distance, Vec3 normal) {
        const Surroundings::Near face{at, distance, normal};
        if (!around.is_covered(ground, face, close)) exit = face;
        return exit.has_value();
      });
      const bool is_far = !exit || exit->distance < -reach;
      if (is_far && around.leads_out(ground, near, reach, close))
        add_at(near);
      else if (exit)
        add_at(*exit);
    }
  }
}

/// Calls add(normal) for the direction in which what touches ground first is kept off it there. Where that is
/// another solid's, it is kept off as what lies there is.
template <class Add>
void for_first_normals(const Surroundings& around, std::uint32_t ground, const MovingEnd& first, Vec3 normal,
                       const GroundSearch& search, Add&& add) {
  if (!around.shapes[ground].is_convex() ||
      !around.is_covered(ground, {first.at, first.radius, normal}, search.close))
    return add(normal);
  for_point_touches(around, ground, first, first.radius + search.margin, search.close,
                    [&](const Surroundings::Near& near) { add(near.normal); });
}

/// Calls add(key, touch) where ground is near the end of a shape, whose number among the ends is `number`.
template <class Add>
void for_end_touches(const Surroundings& around, std::uint32_t ground, const MovingEnd& end,
                     std::uint64_t number, const GroundSearch& search, Add&& add) {
  std::uint64_t n = 0;
  for_point_touches(
      around, ground, end, end.radius + search.reach(end.moves, end.radius), search.close,
      [&](const Surroundings::Near& near) {
        add(ground_key(GroundPart::end, number, ground, n++), Touch{near.distance - end.radius, near.normal});
      });
}

/// Calls add(which, plane, time) for what is touched first by a line, and by its ends alone. Ends count, too,
/// because the line may touch elsewhere already.
template <class Add>
void for_first_touches(const Surroundings& around, std::uint32_t ground, const MovingSegment& moving,
                       const GroundSearch& search, Add&& add) {
  const GroundShape& shape = around.shapes[ground];
  const Segment& line = moving.at;
  const Vec3 p_by = moving.p_by, q_by = moving.q_by;
  const auto see = [&](std::uint64_t which, const MovingSegment& part, double from, double to) {
    const auto first = shape.first_touch(part, search.close);
    if (!first) return;
    const double at = between({from, 0, 0}, {to, 0, 0}, first->at).x;
    const Vec3 by = between(p_by, q_by, at), place = between(line.p, line.q, at) + first->time * by;
    for_first_normals(around, ground, {place, place, line.radius, 0}, first->normal, search,
                      [&](Vec3 normal) { add(which, plane_of(first->time, normal, at, by), first->time); });
  };
  see(0, moving, 0, 1);
  if (line.p == line.q) return;
  see(1, {{line.p, line.p, line.radius}, p_by, p_by}, 0, 0);
  see(2, {{line.q, line.q, line.radius}, q_by, q_by}, 1, 1);
}

/// Calls add(key, touch) where ground is to be kept off the line of a shape, between its ends and where it
/// goes. Places on the line are touch.a, from 0 to 1.
template <class Add>
void for_line_touches(const Surroundings& around, std::uint32_t ground, const MovingSegment& moving,
                      std::uint64_t number, const GroundSearch& search, Add&& add) {
  const GroundShape& shape = around.shapes[ground];
  const auto& [p, q, radius] = moving.at;
  const double moves = moves_of(moving), reach = radius + search.reach(moves, radius);
  Bounds bounds = nowhere;
  include(bounds, p, reach);
  include(bounds, q, reach);
  LineTouches touches;
  if (p != q && shape.bounds().overlaps(bounds)) shape.touch_between(p, q, reach, touches);
  std::uint64_t n = 0;
  for (const LineTouch& each : touches) {
    const std::uint64_t key = ground_key(GroundPart::line, number, ground, n++);
    const Vec3 place = between(p, q, each.at), at = place - each.gap * each.normal;
    const Vec3 along = q - p - dot(q - p, each.normal) * each.normal;
    if (shape.is_convex() && (around.is_covered(ground, {place, each.gap, each.normal}, search.close) ||
                              around.is_flat(ground, at, along, search.close)))
      continue;
    add(key, Touch{each.gap - radius, each.normal, each.at, 0});
  }
  if (search.is_fast(moves, radius))
    for_first_touches(around, ground, moving, search, [&](std::uint64_t which, const Touch& plane, double) {
      add(ground_key(GroundPart::first_of_line, number, ground, which), plane);
    });
}

/// Calls add(which, at, plane, time) for what is touched first by a hull as a whole and by each of its edges.
/// `at` is the place that touches.
template <class Add>
void for_first_touches(const Surroundings& around, std::uint32_t ground, const MovingHullShape& moving,
                       const GroundSearch& search, Add&& add) {
  const GroundShape& shape = around.shapes[ground];
  const auto& [vertices, normals, parts, radius] = moving.hull.at;
  if (const auto first = shape.first_touch(moving.hull, search.close)) {
    std::array<Vec3, 4> then;
    for (std::size_t i = 0; i < 4; ++i) then[i] = moving.particles[i] + first->time * moving.by[i];
    const std::array<double, 4> weights = Linkage::HullShape::weights(then, first->on_hull);
    const Combination at = moving.shape.sum(weights);
    const Vec3 by = weighted(weights, moving.by);
    for_first_normals(around, ground, {first->on_hull, first->on_hull, radius, 0}, first->normal, search,
                      [&](Vec3 normal) { add(0, at, plane_of(first->time, normal, 0, by), first->time); });
  }
  std::uint64_t which = 0;
  for (const ConvexParts::Edge& edge : parts->edges) {
    ++which;
    const MovingSegment line{
        {vertices[edge.a], vertices[edge.b], radius}, moving.hull.by[edge.a], moving.hull.by[edge.b]};
    for_first_touches(around, ground, line, search, [&](std::uint64_t n, const Touch& plane, double time) {
      std::array<double, 4> weights;
      for (std::size_t k = 0; k < 4; ++k)
        weights[k] =
            (1 - plane.a) * moving.shape.corners[edge.a][k] + plane.a * moving.shape.corners[edge.b][k];
      add(3 * which + n, moving.shape.sum(weights), plane, time);
    });
  }
}

/// Returns whether a place is where a corner of a hull is, to within `close` (m).
inline bool is_corner(const Convex& hull, Vec3 place, double close) {
  return std::any_of(hull.vertices.begin(), hull.vertices.end(),
                     [&](Vec3 corner) { return norm(corner - place) <= close; });
}

/// Returns whether the surface of convex shapes is flat all around a place on one of them.
inline bool is_flat(const Surroundings& around, std::uint32_t ground, const Surroundings::Near& near,
                    double close) {
  const Vec3 at = near.place - near.distance * near.normal, n = near.normal;
  const Vec3 u = cross(n, std::abs(n.x) < 0.6 ? Vec3{1, 0, 0} : Vec3{0, 1, 0});
  return around.is_flat(ground, at, u, close) && around.is_flat(ground, at, cross(n, u), close);
}

/// Calls add(key, at, touch) where a hull is to be kept off ground: at its corners, where it lies on edges,
/// and where it goes.
template <class Add>
void for_hull_touches(const Surroundings& around, std::uint32_t ground, const MovingHullShape& moving,
                      const GroundSearch& search, Add&& add) {
  const GroundShape& shape = around.shapes[ground];
  const Convex& hull = moving.hull.at;
  const double moves = moving.moves(), reach = search.reach(moves, moving.shape.half_width);
  const std::uint64_t number = moving.shape.number;
  Vec3 middle{};
  for (const Vec3 v : hull.vertices) middle += 1.0 / static_cast<double>(hull.vertices.size()) * v;
  const auto add_near = [&](GroundPart part, std::uint64_t which, const Surroundings::Near& near) {
    add(ground_key(part, number, ground, which), moving.shape.at(moving.particles, near.place),
        Touch{near.distance - hull.radius, near.normal});
  };
  // Of a mesh the contacts are those of corners, too.
  for (std::uint32_t i = 0; shape.is_convex() && i < hull.vertices.size(); ++i)
    for_point_touches(around, ground, {hull.vertices[i], middle, hull.radius, moves}, reach + hull.radius,
                      search.close,
                      [&](const Surroundings::Near& near) { add_near(GroundPart::corner, i, near); });
  for (const ConvexContact& each : shape.touch_hull(hull, middle, reach)) {
    const Surroundings::Near near{each.on_a, each.gap + hull.radius, each.normal};
    if (shape.is_convex() &&
        (is_corner(hull, each.on_a, search.close) || around.is_covered(ground, near, search.close) ||
         is_flat(around, ground, near, search.close)))
      continue;
    add_near(GroundPart::hull, each.key, near);
  }
  if (!search.is_fast(moves, moving.shape.half_width)) return;
  for_first_touches(around, ground, moving, search,
                    [&](std::uint64_t which, const Combination& at, const Touch& plane, double) {
                      add(ground_key(GroundPart::first_of_hull, number, ground, which), at, plane);
                    });
}

/// Returns whether what moves goes beyond a plane that it should stay behind, although others pushed it.
inline bool is_missed(const Touch& plane, double time, double tolerance) {
  return plane.gap * (1 - time) > tolerance * time;
}

}  // namespace plumb::detail
