#include <algorithm>
#include <cmath>

#include "contact/shapes/hulls/convex.hpp"
#include "contact/shapes/hulls/simplex.hpp"

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

struct Gap {
  double size = -INFINITY;  ///< m along the normal; negative if they overlap
  Vec3 normal{};            ///< from b to a
};

/// Returns the gap between both shapes along a unit vector.
Gap gap_along(const Convex& a, const Convex& b, Vec3 n) {
  const double to = dot(a.vertices[farthest(a.vertices, -1.0 * n)], n);
  return {to - dot(b.vertices[farthest(b.vertices, n)], n), n};
}

Gap widest_of_faces(const Convex& a, const Convex& b) {
  Gap best;
  const auto see = [&](const Gap& gap) {
    if (gap.size > best.size) best = gap;
  };
  for (const Vec3 n : b.normals) see(gap_along(a, b, n));
  for (const Vec3 n : a.normals) see(gap_along(a, b, -1.0 * n));
  return best;
}

/// Calls `seen(along)` with the direction of every edge; a segment has one.
template <class Seen>
void for_each_edge(const Convex& shape, Seen&& seen) {
  if (shape.parts) {
    for (const ConvexParts::Edge& edge : shape.parts->edges)
      seen(shape.vertices[edge.b] - shape.vertices[edge.a]);
  } else if (shape.vertices.size() == 2) {
    seen(shape.vertices[1] - shape.vertices[0]);
  }
}

Gap widest_of_edges(const Convex& a, const Convex& b) {
  Gap best;
  for_each_edge(a, [&](Vec3 u) {
    for_each_edge(b, [&](Vec3 v) {
      const Vec3 across = cross(u, v);
      const double length = norm(across);
      if (!(length > 1e-6 * norm(u) * norm(v))) return;  // parallel
      for (const double sign : {1.0, -1.0})
        if (const Gap gap = gap_along(a, b, (sign / length) * across); gap.size > best.size) best = gap;
    });
  });
  return best;
}

Nearness part_overlap(const Convex& a, const Convex& b) {
  Gap best = widest_of_faces(a, b);
  const Gap edges = widest_of_edges(a, b);
  if (best.size == -INFINITY || edges.size > (1 - edges_win_by) * best.size) best = edges;
  if (best.size == -INFINITY) best = {0, {0, 1, 0}};  // two points, or parallel segments, in one place
  const Vec3 on_a = a.vertices[farthest(a.vertices, -1.0 * best.normal)];
  return {best.size, best.normal, on_a, on_a - best.size * best.normal};
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
