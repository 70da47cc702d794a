#include "queries/casts.hpp"

#include <algorithm>

#include "contact/shapes/sweep.hpp"

namespace plumb::detail {
namespace {

/// Casts end this share of the sizes before a surface, and go the rest along the normal there. Nearer ones
/// would know the normal of a box's touch no better: it is that of a difference which rounding spoils.
constexpr double near_enough = 1e-8;
/// Faces of a flat shape lie in one plane to within this share of the sizes.
constexpr double flat = 1e-13;

double size_of(const Convex& shape) {
  double most = 0;
  for (const Vec3 v : shape.vertices) most = std::max(most, norm(v - shape.vertices[0]));
  return most + shape.radius;
}

/// Returns how far (m) a probe may go until it has passed a shape.
double farthest(const Probe& probe, std::span<const Vec3> vertices, double radius) {
  double most = -INFINITY;
  for (const Vec3 v : vertices) most = std::max(most, dot(v - probe.origin, probe.direction));
  return std::min(probe.length, most + radius + norm(probe.reach()));
}

Strike within(const Strike& strike, const Probe& probe) {
  return strike.distance <= probe.length ? strike : Strike{};
}

/// Cuts a ray with the planes of all faces (Cyrus and Beck 1978).
Strike clip(const Probe& probe, const Convex& shape) {
  Strike in{0, {}, {}};
  double out = INFINITY;
  bool is_outside = false;
  for (std::uint32_t i = 0; i < shape.faces(); ++i) {
    const Vec3 n = shape.normals[i];
    const double depth = dot(n, shape.vertices[shape.parts->face(i)[0]] - probe.origin);
    const double along = dot(n, probe.direction);
    if (along == 0 && depth < 0) return {};
    if (along < 0 && depth < 0 && depth / along > in.distance) {
      in = {depth / along, n, {}};
      is_outside = true;
    }
    if (along > 0) out = std::min(out, depth / along);
  }
  if (in.distance > out + flat * (in.distance + size_of(shape)) || in.distance > probe.length) return {};
  if (!is_outside) {
    const Strike near = near_convex(probe.origin, shape);
    return {0, near.normal, near.point};
  }
  in.point = probe.at(in.distance);
  return in;
}

/// Says where a probe is when it comes as near to a shape as near_enough says, as a share of `length` (m).
std::optional<double> advance(const Probe& probe, const Convex& shape, double length) {
  const Vec3 by = length * probe.direction;
  const double close =
      near_enough * (size_of(shape) + norm(probe.reach())) + 1e-14 * norm(probe.origin - shape.vertices[0]);
  if (!probe.box) {
    const auto first = sweep(MovingSegment{{probe.origin, probe.origin, probe.radius}, by, by}, shape, close);
    return first ? std::optional(first->time) : std::nullopt;
  }
  std::array<Vec3, 8> ways, room;
  ways.fill(by);
  const auto first = sweep(MovingHull{probe.box->shape(), ways, room}, shape, close);
  return first ? std::optional(first->time) : std::nullopt;
}

/// Says how near a probe is to a shape when it has gone a distance (m).
Nearness nearness_at(const Probe& probe, double distance, const Convex& shape) {
  std::array<Vec3, 8> there;
  const Convex start = probe.shape();
  for (std::size_t i = 0; i < start.vertices.size(); ++i)
    there[i] = start.vertices[i] + distance * probe.direction;
  return nearness({std::span(there).first(start.vertices.size()), start.normals, start.parts, 0}, shape);
}

Bounds around(const Probe& probe) {
  const Vec3 reach = probe.reach();
  return {probe.origin - reach, probe.origin + reach};
}

/// Casts a ray at a triangle.
Strike cast_ray(const Probe& probe, const TriangleMesh& mesh, std::uint32_t i, double length) {
  const Triangle triangle = mesh.triangle(i);
  const Vec3 n = mesh.normal(i), to = probe.at(length);
  if (!crosses(triangle, probe.origin, to)) return {};
  const double along = dot(n, probe.direction);
  const double distance = std::clamp(dot(n, triangle[0] - probe.origin) / along, 0.0, length);
  return {distance, along > 0 ? -1.0 * n : n, probe.at(distance)};
}

}  // namespace

Strike cast(const Probe& probe, const PlaneNow& plane) {
  if (const Strike start = overlap(probe, plane)) return start;
  const double along = -dot(plane.normal, probe.direction);
  if (!(along > 0)) return {};
  const auto height = [&](Vec3 place) { return dot(plane.normal, place) - plane.offset - probe.radius; };
  Vec3 lowest = probe.shape().vertices[0];
  for (const Vec3 v : probe.shape().vertices)
    if (height(v) < height(lowest)) lowest = v;
  const double distance = height(lowest) / along;
  const Vec3 point = lowest + distance * probe.direction - probe.radius * plane.normal;
  return within({distance, plane.normal, point}, probe);
}

Strike cast(const Probe& probe, const Convex& shape) {
  const double radii = probe.radius + shape.radius;
  if (!probe.box && radii == 0 && shape.faces() > 0) return clip(probe, shape);
  const double length = farthest(probe, shape.vertices, shape.radius);
  if (length < 0) return {};
  const auto share = advance(probe, shape, length);
  if (!share) return {};
  if (*share == 0)
    if (const Strike start = overlap(probe, shape)) return start;
  double distance = *share * length;
  Nearness near = nearness_at(probe, distance, shape);
  const double gap = near.distance - radii, along = -dot(near.normal, probe.direction);
  if (gap > 0 && along > 0) distance += gap / along;
  if (radii > 0) near = nearness_at(probe, distance, shape);  // the normal turns on the rest of the way
  return within({distance, near.normal, near.on_b + shape.radius * near.normal}, probe);
}

Strike cast(const Probe& probe, const TriangleMesh& mesh) {
  const bool is_ray = !probe.box && probe.radius == 0;
  if (const Strike start = overlap(probe, mesh)) return start;
  const Bounds bounds = mesh.bounds();
  const double length =
      farthest(probe, std::array{0.5 * (bounds.low + bounds.high)}, norm(bounds.high - bounds.low));
  Strike first;
  std::uint32_t at = TriangleMesh::none;
  double best = length;
  mesh.find_along(around(probe), probe.direction, best, [&](std::uint32_t i) {
    const Triangle triangle = mesh.triangle(i);
    const Strike strike =
        is_ray ? cast_ray(probe, mesh, i, length) : cast(probe, Convex{.vertices = triangle, .normals = {}});
    if (!strike || strike.distance > first.distance || (strike.distance == first.distance && i > at)) return;
    first = strike;
    at = i;
    best = std::min(best, first.distance);
  });
  return within(first, probe);
}

Strike strike_on_capsule(const Probe& probe, const Thing& capsule, double distance) {
  const Strike near = near_capsule(probe.at(distance), capsule.p, capsule.q, capsule.radius);
  return {distance, near.normal, near.point};
}

}  // namespace plumb::detail
