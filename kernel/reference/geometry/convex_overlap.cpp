// This file finds whether two convex meshes overlap, that is whether the origin is in the set of differences
// of their points.
//
// The search (Gilbert, Johnson, Keerthi 1988) walks towards the origin over simplices of that set's corners,
// in ten rounds or so. Nearer than 1e-8 of their size its direction is lost to rounding and it goes in
// circles. Separating axes tell then.
#include <algorithm>
#include <cmath>
#include <initializer_list>

#include "plumb/reference/bounding.hpp"
#include "scene/barycentric.hpp"

namespace plumb {
namespace {

Vec3 furthest(const std::vector<Vec3>& points, Vec3 direction) {
  return *std::max_element(points.begin(), points.end(),
                           [&](Vec3 a, Vec3 b) { return dot(a, direction) < dot(b, direction); });
}

double extent(const std::vector<Vec3>& points) {
  double extent = 0;
  for (const Vec3 p : points) extent = std::max(extent, norm(p - points.front()));
  return extent;
}

/// Holds up to four points, and the place between them that is nearest to the origin.
struct Simplex {
  std::array<Vec3, 4> point{};
  std::size_t size = 0;
  Vec3 nearest{};
};

/// Takes `p` for the best if it is nearer.
void improve(Simplex& best, Vec3 nearest, std::initializer_list<Vec3> points) {
  if (best.size != 0 && !(dot(nearest, nearest) < dot(best.nearest, best.nearest))) return;
  best.nearest = nearest;
  best.size = points.size();
  std::copy(points.begin(), points.end(), best.point.begin());
}

/// Looks for the nearest place inside the line between two points.
void try_line(Simplex& best, Vec3 a, Vec3 b) {
  const Vec3 u = b - a;
  const double t = -dot(a, u) / dot(u, u);
  if (t > 0 && t < 1) improve(best, a + t * u, {a, b});
}

/// Looks for the nearest place inside a triangle.
void try_triangle(Simplex& best, Vec3 a, Vec3 b, Vec3 c) {
  const Vec3 u = b - a, v = c - a;
  const double uu = dot(u, u), uv = dot(u, v), vv = dot(v, v), ua = dot(u, a), va = dot(v, a);
  const double determinant = uu * vv - uv * uv;
  const double s = (uv * va - vv * ua) / determinant, t = (uv * ua - uu * va) / determinant;
  if (s > 0 && t > 0 && s + t < 1) improve(best, a + s * u + t * v, {a, b, c});
}

/// Looks at all corners, edges and triangles, and at the whole, for what is nearest to the origin. One of
/// them is right however flat the simplex is, and none yields a place outside it.
Simplex nearest_part(const Simplex& all) {
  const auto& p = all.point;
  Simplex best;
  for (std::size_t i = 0; i < all.size; ++i) {
    improve(best, p[i], {p[i]});
    for (std::size_t j = 0; j < i; ++j) {
      try_line(best, p[i], p[j]);
      for (std::size_t k = 0; k < j; ++k) try_triangle(best, p[i], p[j], p[k]);
    }
  }
  if (all.size == 4) {
    const std::array<double, 4> weights = detail::Barycentric(p).weights({});
    if (std::all_of(weights.begin(), weights.end(), [](double w) { return w > 0; }))
      improve(best, {}, {p[0], p[1], p[2], p[3]});
  }
  return best;
}

/// Returns whether all differences lie on one side of the origin along an axis, by more than `gap` (m).
bool separates(Vec3 axis, const ConvexMesh& a, const ConvexMesh& b, double gap) {
  const auto clear = [&](Vec3 way) {
    return dot(way, furthest(a.vertices, -1 * way) - furthest(b.vertices, way)) > gap * norm(way);
  };
  return clear(axis) || clear(-1 * axis);
}

/// Tries every normal of a face and every product of two edges. That is slow, and right to rounding however
/// near the two are.
bool separated_by_axes(const ConvexMesh& a, const ConvexMesh& b, double gap) {
  const auto edges = [](const ConvexMesh& mesh) {
    std::vector<Vec3> out;
    for (const auto& face : mesh.faces)
      for (std::size_t k = 0; k < 3; ++k) {
        const std::uint32_t from = face[k], to = face[(k + 1) % 3];
        if (from < to) out.push_back(mesh.vertices[to] - mesh.vertices[from]);
      }
    return out;
  };
  const auto across_face = [&](const ConvexMesh& mesh) {
    return std::any_of(mesh.faces.begin(), mesh.faces.end(), [&](const auto& face) {
      const Vec3 p = mesh.vertices[face[0]];
      return separates(cross(mesh.vertices[face[1]] - p, mesh.vertices[face[2]] - p), a, b, gap);
    });
  };
  if (across_face(a) || across_face(b)) return true;
  const std::vector<Vec3> of_b = edges(b);
  for (const Vec3 u : edges(a))
    for (const Vec3 v : of_b)
      if (separates(cross(u, v), a, b, gap)) return true;
  return false;
}

}  // namespace

bool overlap(const ConvexMesh& a, const ConvexMesh& b) {
  if (a.vertices.empty() || b.vertices.empty()) return false;
  const double touching = 1e-12 * (extent(a.vertices) + extent(b.vertices));
  Simplex simplex{.point = {a.vertices.front() - b.vertices.front()}, .size = 1};
  for (int round = 0; round < 40; ++round) {
    simplex = nearest_part(simplex);
    const Vec3 v = simplex.nearest;
    const double distance = norm(v);
    if (distance <= touching || simplex.size == 4) return true;
    const Vec3 corner = furthest(a.vertices, -1 * v) - furthest(b.vertices, v);
    if (dot(v, corner) > touching * distance) return false;  // all differences are on this side of the origin
    simplex.point[simplex.size++] = corner;
  }
  return !separated_by_axes(a, b, touching);
}

}  // namespace plumb
