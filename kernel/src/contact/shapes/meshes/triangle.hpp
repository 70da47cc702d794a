#pragma once

#include <array>
#include <cmath>
#include <cstdint>
#include <optional>

#include "contact/shapes/touch.hpp"
#include "plumb/vec3.hpp"

/// This file finds where points and segments come nearest to a triangle, in double and without a branch that
/// rounding could turn into another answer than a place nearby.
namespace plumb::detail {

using Triangle = std::array<Vec3, 3>;

/// Says which part of a triangle a place is on: the vertices 0 to 2, the edges from each vertex to the next,
/// or the face.
enum class TrianglePart : std::uint8_t { vertex0, vertex1, vertex2, edge0, edge1, edge2, face };

struct TrianglePlace {
  Vec3 at{};
  TrianglePart part = TrianglePart::face;
};

/// Finds the point of a triangle that is nearest to p (Ericson 2005, section 5.1.5).
inline TrianglePlace nearest_on(const Triangle& t, Vec3 p) {
  using enum TrianglePart;
  const Vec3 ab = t[1] - t[0], ac = t[2] - t[0], ap = p - t[0];
  const double d1 = dot(ab, ap), d2 = dot(ac, ap);
  if (d1 <= 0 && d2 <= 0) return {t[0], vertex0};
  const Vec3 bp = p - t[1];
  const double d3 = dot(ab, bp), d4 = dot(ac, bp);
  if (d3 >= 0 && d4 <= d3) return {t[1], vertex1};
  const double vc = d1 * d4 - d3 * d2;
  if (vc <= 0 && d1 >= 0 && d3 <= 0) return {t[0] + (d1 / (d1 - d3)) * ab, edge0};
  const Vec3 cp = p - t[2];
  const double d5 = dot(ab, cp), d6 = dot(ac, cp);
  if (d6 >= 0 && d5 <= d6) return {t[2], vertex2};
  const double vb = d5 * d2 - d1 * d6;
  if (vb <= 0 && d2 >= 0 && d6 <= 0) return {t[0] + (d2 / (d2 - d6)) * ac, edge2};
  const double va = d3 * d6 - d5 * d4;
  if (va <= 0 && d4 >= d3 && d5 >= d6)
    return {t[1] + ((d4 - d3) / ((d4 - d3) + (d5 - d6))) * (t[2] - t[1]), edge1};
  const double over = 1 / (va + vb + vc);
  return {t[0] + (vb * over) * ab + (vc * over) * ac, face};
}

/// Returns whether the segment from p to q passes through a triangle. One that only touches it may count
/// either way.
inline std::optional<TrianglePart> crossing(const Triangle& t, Vec3 p, Vec3 q) {
  using enum TrianglePart;
  const Vec3 along = q - p, a = t[0] - p, b = t[1] - p, c = t[2] - p;
  const Vec3 normal = cross(t[1] - t[0], t[2] - t[0]);
  const double from = dot(normal, a), to = dot(normal, along);
  if (to == 0 || !(from / to >= 0 && from / to <= 1)) return std::nullopt;
  // The line passes on the same side of all edges.
  const double u = dot(along, cross(b, c)), v = dot(along, cross(c, a)), w = dot(along, cross(a, b));
  if (!((u >= 0 && v >= 0 && w >= 0) || (u <= 0 && v <= 0 && w <= 0))) return std::nullopt;
  if (u == 0) return v == 0 ? vertex2 : w == 0 ? vertex1 : edge1;
  if (v == 0) return w == 0 ? vertex0 : edge2;
  return w == 0 ? edge0 : face;
}
inline bool crosses(const Triangle& t, Vec3 p, Vec3 q) {
  return crossing(t, p, q).has_value();
}

/// Says where a segment and a triangle are nearest: places on both, and their distance (m), which is 0 where
/// they cross.
struct SegmentToTriangle {
  Vec3 on_segment{}, on_triangle{};
  double distance = 0;
};
inline SegmentToTriangle nearest_on(const Triangle& t, Vec3 p, Vec3 q) {
  const auto pair = [](Vec3 a, Vec3 b) { return SegmentToTriangle{a, b, norm(a - b)}; };
  SegmentToTriangle out = pair(p, nearest_on(t, p).at);
  if (const auto end = pair(q, nearest_on(t, q).at); end.distance < out.distance) out = end;
  for (int k = 0; k < 3; ++k) {
    const Segment edge{t[k], t[(k + 1) % 3], 0};
    const Touch near = touch({p, q, 0}, edge);
    const auto middle = pair(between(p, q, near.a), between(edge.p, edge.q, near.b));
    if (middle.distance < out.distance) out = middle;
  }
  if (out.distance > 0 && crosses(t, p, q)) {
    const Vec3 normal = cross(t[1] - t[0], t[2] - t[0]);
    const Vec3 at = between(p, q, dot(normal, t[0] - p) / dot(normal, q - p));
    return {at, at, 0};
  }
  return out;
}

}  // namespace plumb::detail
