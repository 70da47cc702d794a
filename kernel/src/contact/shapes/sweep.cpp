#include "contact/shapes/sweep.hpp"

#include <algorithm>

namespace plumb::detail {
namespace {

/// Returns how far a segment is from a triangle. Where they cross, the normal is against `motion`.
Separation separation(const Triangle& triangle, Vec3 p, Vec3 q, Vec3 motion) {
  const SegmentToTriangle near = nearest_on(triangle, p, q);
  if (near.distance > 1e-12)
    return {near.distance, (1 / near.distance) * (near.on_segment - near.on_triangle), near.on_segment};
  const Vec3 normal = cross(triangle[1] - triangle[0], triangle[2] - triangle[0]);
  return {0, (dot(normal, motion) > 0 ? -1 : 1) / norm(normal) * normal, near.on_segment};
}

}  // namespace

Bounds bounds_of(const MovingSegment& moving) {
  const auto& [p, q, radius] = moving.at;
  Bounds out = nowhere;
  for (const Vec3 end : {p, q, p + moving.p_by, q + moving.q_by}) include(out, end, radius);
  return out;
}

Bounds bounds_of(const MovingHull& moving) {
  Bounds out = nowhere;
  for (std::size_t i = 0; i < moving.by.size(); ++i) {
    include(out, moving.at.vertices[i], moving.at.radius);
    include(out, moving.at.vertices[i] + moving.by[i], moving.at.radius);
  }
  return out;
}

std::optional<FirstTouch> sweep(const MovingSegment& moving, const Triangle& triangle, double close) {
  const Vec3 motion = 0.5 * (moving.p_by + moving.q_by);
  return sweep(moving, close, [&](Vec3 p, Vec3 q) { return separation(triangle, p, q, motion); });
}

std::optional<FirstTouch> sweep(const MovingSegment& moving, const Convex& shape, double close) {
  return sweep(moving, close, [&](Vec3 p, Vec3 q) {
    const std::array<Vec3, 2> line{p, q};
    const Nearness near = nearness({.vertices = std::span(line).first(p == q ? 1 : 2), .normals = {}}, shape);
    return Separation{near.distance - shape.radius, near.normal, near.on_a};
  });
}

std::optional<FirstPairTouch> sweep(const MovingSegment& a, const MovingSegment& b, double close) {
  FirstPairTouch out;
  const auto at = [](const MovingSegment& each, double t) {
    return Segment{each.at.p + t * each.p_by, each.at.q + t * each.q_by, each.at.radius};
  };
  const auto see = [&](double t) {
    const Touch now = touch(at(a, t), at(b, t));
    out = {t, now.normal, now.a, now.b};
    return Separation{now.gap, now.normal, {}};
  };
  // Places between the ends of a line move by no more than one of its ends does.
  const auto approach = [&](Vec3 n) {
    return std::max(dot(n, b.p_by), dot(n, b.q_by)) - std::min(dot(n, a.p_by), dot(n, a.q_by));
  };
  if (!advance(close, see, approach)) return std::nullopt;
  return out;
}

std::optional<FirstHullTouch> sweep(const MovingHull& moving, const Convex& shape, double close) {
  FirstHullTouch out;
  const auto see = [&](double t) {
    for (std::size_t i = 0; i < moving.by.size(); ++i)
      moving.there[i] = moving.at.vertices[i] + t * moving.by[i];
    // Faces part what overlaps, which nothing here is but at the start.
    const Nearness near = nearness({.vertices = moving.there, .normals = {}}, shape);
    out = {t, near.normal, near.on_a};
    return Separation{near.distance - moving.at.radius - shape.radius, near.normal, {}};
  };
  const auto approach = [&](Vec3 n) {
    double most = 0;
    for (const Vec3 by : moving.by) most = std::max(most, -dot(n, by));
    return most;
  };
  if (!advance(close, see, approach)) return std::nullopt;
  return out;
}

namespace {

/// Finds the first touch with triangles of a mesh. `touch_of(triangle)` sweeps over one of them, and
/// `place_of(touch)` is where what moves is then.
template <class Touch, class TouchOf, class PlaceOf>
std::optional<Touch> first_of(const TriangleMesh& mesh, const Bounds& box, TouchOf touch_of,
                              PlaceOf place_of) {
  std::optional<Touch> first;
  std::uint32_t at = TriangleMesh::none;
  mesh.find(box, [&](std::uint32_t i) {
    const Triangle triangle = mesh.triangle(i);
    std::optional<Touch> touch = touch_of(triangle);
    if (!touch || touch->time == 0) return;
    if (first && (touch->time > first->time || (touch->time == first->time && i > at))) return;
    const TrianglePart part = nearest_on(triangle, place_of(triangle, *touch)).part;
    if (part == TrianglePart::face)
      touch->normal = (dot(mesh.normal(i), touch->normal) < 0 ? -1 : 1) * mesh.normal(i);
    const MeshPart of = mesh.part(i, part);
    if (!mesh.faces(of, touch->normal) || mesh.leads_inside(of, touch->normal)) return;
    first = touch;
    at = i;
  });
  return first;
}

}  // namespace

std::optional<FirstTouch> sweep(const MovingSegment& moving, const TriangleMesh& mesh, double close) {
  const auto touch_of = [&](const Triangle& triangle) { return sweep(moving, triangle, close); };
  return first_of<FirstTouch>(
      mesh, bounds_of(moving), touch_of, [&](const Triangle& triangle, const FirstTouch& touch) {
        const double t = touch.time;
        return nearest_on(triangle, moving.at.p + t * moving.p_by, moving.at.q + t * moving.q_by).on_segment;
      });
}

std::optional<FirstHullTouch> sweep(const MovingHull& moving, const TriangleMesh& mesh, double close) {
  const auto touch_of = [&](const Triangle& triangle) {
    return sweep(moving, Convex{.vertices = triangle, .normals = {}}, close);
  };
  return first_of<FirstHullTouch>(mesh, bounds_of(moving), touch_of,
                                  [](const Triangle&, const FirstHullTouch& touch) { return touch.on_hull; });
}

}  // namespace plumb::detail
