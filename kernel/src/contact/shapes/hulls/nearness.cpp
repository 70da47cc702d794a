#include <algorithm>
#include <cmath>

#include "contact/shapes/hulls/convex.hpp"
#include "contact/shapes/hulls/simplex.hpp"
#include "contact/shapes/touch.hpp"

namespace plumb::detail {
namespace {

/// The search ends where it would come nearer by less than this share of the distance.
constexpr double exact = 1e-14;
/// Shapes overlap if they are nearer than this share of their size.
constexpr double touching = 1e-13;
constexpr int most_steps = 100;
/// Two edges part shapes that overlap only if they do so by this much less than a face does, relatively. So a
/// face stays one where both are about as good.
constexpr double edges_win_by = 0.02;

std::uint32_t farthest(std::span<const Vec3> vertices, Vec3 along) {
  std::uint32_t best = 0;
  double most = dot(vertices[0], along);
  for (std::uint32_t i = 1; i < vertices.size(); ++i)
    if (const double at = dot(vertices[i], along); at > most) {
      most = at;
      best = i;
    }
  return best;
}

double size_of(const Convex& shape) {
  double most = 0;
  for (const Vec3 v : shape.vertices) {
    const Vec3 apart = v - shape.vertices[0];
    most = std::max(most, dot(apart, apart));
  }
  return std::sqrt(most);
}

/// The pair of vertices, one of each shape, that a point of the simplex stands for.
std::uint64_t pair_name(std::uint32_t in_a, std::uint32_t in_b) {
  return std::uint64_t{in_a} << 32 | in_b;
}

/// Searches the differences of both shapes' points for the nearest to the origin. Returns false if they hold
/// the origin.
bool find_apart(const Convex& a, const Convex& b, Simplex& simplex) {
  const double size = size_of(a) + size_of(b);
  simplex.count = 1;
  simplex.points[0] = a.vertices[0] - b.vertices[0];
  simplex.names[0] = pair_name(0, 0);
  simplex.weights[0] = 1;
  double last = INFINITY;
  for (int step = 0; step < most_steps; ++step) {
    const Vec3 v = simplex.place();
    const double square = dot(v, v);
    if (!(square > touching * touching * size * size)) return false;
    if (square >= last) return true;  // rounding
    last = square;
    const std::uint32_t i = farthest(a.vertices, -1.0 * v), k = farthest(b.vertices, v);
    const Vec3 w = a.vertices[i] - b.vertices[k];
    const std::uint64_t name = pair_name(i, k);
    const auto names_end = simplex.names.begin() + simplex.count;
    if (dot(v, v - w) <= exact * square || std::find(simplex.names.begin(), names_end, name) != names_end)
      return true;
    const Simplex before = simplex;
    simplex.points[simplex.count] = w;
    simplex.names[simplex.count++] = name;
    if (!reduce_to_nearest(simplex)) return false;
    const Vec3 next = simplex.place();
    if (dot(next, next) >= square) {
      simplex = before;
      return true;
    }
  }
  return true;
}

/// Says how far apart two shapes are along a unit vector from b to a, and between which of their vertices.
struct Gap {
  double size = -INFINITY;  ///< m; negative if they overlap
  Vec3 normal{};
  std::uint32_t of_a = 0, of_b = 0;
};

Gap gap_along(const Convex& a, const Convex& b, Vec3 n) {
  const std::uint32_t i = farthest(a.vertices, -1.0 * n), k = farthest(b.vertices, n);
  return {dot(a.vertices[i] - b.vertices[k], n), n, i, k};
}

/// Returns how two shapes are parted best along the normal of a face. They touch where the vertex is that is
/// deepest below it.
Nearness part_by_face(const Convex& a, const Convex& b) {
  Nearness best{.distance = -INFINITY};
  for (const Vec3 n : b.normals)
    if (const Gap gap = gap_along(a, b, n); gap.size > best.distance)
      best = {gap.size, n, a.vertices[gap.of_a], a.vertices[gap.of_a] - gap.size * n};
  for (const Vec3 out : a.normals)
    if (const Gap gap = gap_along(a, b, -1.0 * out); gap.size > best.distance)
      best = {gap.size, gap.normal, b.vertices[gap.of_b] + gap.size * gap.normal, b.vertices[gap.of_b]};
  return best;
}

/// Calls `seen(edge)` with the vertices of every edge; a segment has one.
template <class Seen>
void for_each_edge(const Convex& shape, Seen&& seen) {
  if (shape.parts) {
    for (const ConvexParts::Edge& edge : shape.parts->edges) seen(edge);
  } else if (shape.vertices.size() == 2) {
    seen(ConvexParts::Edge{0, 1, 0, 0});
  }
}

/// Returns how two shapes are parted best across two of their edges, which touch where they cross. A push
/// elsewhere on them would turn the shapes into each other. Edges that are farthest along the direction are
/// meant, not others that are parallel to them. A line is pushed at an end: within ground, it is kept off
/// there, and what crosses it between would be pushed twice.
Nearness part_across_edges(const Convex& a, const Convex& b) {
  const bool are_solid = a.faces() > 0 && b.faces() > 0;
  Nearness best{.distance = -INFINITY};
  for_each_edge(a, [&](const ConvexParts::Edge& of_a) {
    const Segment one{a.vertices[of_a.a], a.vertices[of_a.b], 0};
    for_each_edge(b, [&](const ConvexParts::Edge& of_b) {
      const Segment other{b.vertices[of_b.a], b.vertices[of_b.b], 0};
      const Vec3 u = one.q - one.p, v = other.q - other.p, across = cross(u, v);
      const double length = norm(across);
      if (!(length > 1e-6 * norm(u) * norm(v))) return;  // parallel
      for (const double sign : {1.0, -1.0}) {
        const Gap gap = gap_along(a, b, (sign / length) * across);
        const bool are_farthest =
            (gap.of_a == of_a.a || gap.of_a == of_a.b) && (gap.of_b == of_b.a || gap.of_b == of_b.b);
        if (!are_farthest || !(gap.size > best.distance)) continue;
        const Vec3 on_a = are_solid ? between(one.p, one.q, touch(one, other).a) : a.vertices[gap.of_a];
        best = {gap.size, gap.normal, on_a, on_a - gap.size * gap.normal};
      }
    });
  });
  return best;
}

Nearness part_overlap(const Convex& a, const Convex& b) {
  const Nearness face = part_by_face(a, b), edges = part_across_edges(a, b);
  const bool any_face = face.distance > -INFINITY;
  if (edges.distance > (any_face ? (1 - edges_win_by) * face.distance : -INFINITY)) return edges;
  if (any_face) return face;
  return {0, {0, 1, 0}, a.vertices[0], a.vertices[0]};  // two points, or parallel segments, in one place
}

}  // namespace

Nearness nearness(const Convex& a, const Convex& b) {
  Simplex simplex;
  if (!find_apart(a, b, simplex)) return part_overlap(a, b);
  Nearness out;
  for (std::uint32_t i = 0; i < simplex.count; ++i) {
    out.on_a += simplex.weights[i] * a.vertices[simplex.names[i] >> 32];
    out.on_b += simplex.weights[i] * b.vertices[simplex.names[i] & 0xffffffff];
  }
  const Vec3 apart = out.on_a - out.on_b;
  out.distance = norm(apart);
  out.normal = (1 / out.distance) * apart;
  return out;
}

}  // namespace plumb::detail
