#include "contact/shapes/hulls/simplex.hpp"

#include <cmath>

namespace plumb::detail {
namespace {

/// Makes a simplex of some points of another.
Simplex part(const Simplex& of, std::initializer_list<std::uint32_t> which) {
  Simplex out;
  for (const std::uint32_t i : which) {
    out.points[out.count] = of.points[i];
    out.names[out.count++] = of.names[i];
  }
  return out;
}

Simplex nearest_in_segment(const Simplex& s) {
  const Vec3 along = s.points[1] - s.points[0];
  const double square = dot(along, along), t = -dot(s.points[0], along);
  if (!(t > 0)) {
    Simplex out = part(s, {0});
    out.weights[0] = 1;
    return out;
  }
  if (t >= square) {
    Simplex out = part(s, {1});
    out.weights[0] = 1;
    return out;
  }
  Simplex out = s;
  out.weights[0] = 1 - t / square;
  out.weights[1] = t / square;
  return out;
}

const Simplex& nearer(const Simplex& a, const Simplex& b) {
  const Vec3 at_a = a.place(), at_b = b.place();
  return dot(at_b, at_b) < dot(at_a, at_a) ? b : a;
}

/// The origin is nearest to an edge unless it is above the face. Areas of the three triangles that its
/// projection makes are the weights.
Simplex nearest_in_triangle(const Simplex& s) {
  const Vec3 a = s.points[0], b = s.points[1], c = s.points[2];
  const Vec3 normal = cross(b - a, c - a);
  const double u = dot(normal, cross(b, c)), v = dot(normal, cross(c, a)), w = dot(normal, cross(a, b));
  if (u > 0 && v > 0 && w > 0) {
    Simplex out = s;
    const double over = 1 / (u + v + w);
    out.weights = {u * over, v * over, w * over, 0};
    return out;
  }
  const Simplex ab = nearest_in_segment(part(s, {0, 1})), bc = nearest_in_segment(part(s, {1, 2})),
                ca = nearest_in_segment(part(s, {2, 0}));
  return nearer(nearer(ab, bc), ca);
}

/// Returns whether the origin is on another side of the face p, q, r than the fourth point, or on it.
bool is_outside(Vec3 p, Vec3 q, Vec3 r, Vec3 other) {
  const Vec3 normal = cross(q - p, r - p);
  return -dot(normal, p) * dot(normal, other - p) <= 0;
}

}  // namespace

bool reduce_to_nearest(Simplex& s) {
  if (s.count == 1) s.weights[0] = 1;
  if (s.count == 2) s = nearest_in_segment(s);
  if (s.count == 3) s = nearest_in_triangle(s);
  if (s.count < 4) return true;
  constexpr std::uint32_t faces[4][4] = {{0, 1, 2, 3}, {0, 2, 3, 1}, {0, 3, 1, 2}, {1, 3, 2, 0}};
  Simplex best;
  for (const auto& [i, j, k, other] : faces) {
    if (!is_outside(s.points[i], s.points[j], s.points[k], s.points[other])) continue;
    const Simplex face = nearest_in_triangle(part(s, {i, j, k}));
    best = best.count == 0 ? face : nearer(best, face);
  }
  if (best.count == 0) return false;
  s = best;
  return true;
}

}  // namespace plumb::detail
