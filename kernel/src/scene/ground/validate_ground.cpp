#include "scene/ground/validate_ground.hpp"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <tuple>

#include "plumb/layouts/memory.hpp"
#include "scene/ground/weld.hpp"

namespace plumb::detail {
namespace {

/// Points lie in one plane if their hull is thinner than this share of its size.
constexpr double flat = 1e-6;
/// A triangle has no area if it is narrower than this share of its longest edge.
constexpr double no_area = 1e-9;

void require_amount(double value, const char* what, const std::string& name) {
  if (!(value >= 0 && std::isfinite(value)))
    refuse(name, ": ", what, " must be finite and not negative, got ", value, " m");
}

/// Returns the largest value of all points.
template <class Of>
double most(std::span<const Vec3> points, Of of, Vec3& at) {
  double best = -1;
  for (const Vec3 p : points)
    if (const double value = of(p); value > best) {
      best = value;
      at = p;
    }
  return best;
}

void require_volume(std::span<const Vec3> points, const std::string& name) {
  for (std::size_t i = 0; i < points.size(); ++i)
    if (!is_finite(points[i])) refuse(name, ": point ", i, " is not finite: ", points[i]);
  Vec3 a{}, b{}, c{};
  if (!points.empty()) a = points[0];
  const double size = most(
      points, [&](Vec3 p) { return norm(p - a); }, b);
  most(
      points, [&](Vec3 p) { return norm(cross(p - a, b - a)); }, c);
  const Vec3 normal = cross(b - a, c - a);
  const double height = most(
      points, [&](Vec3 p) { return std::abs(dot(normal, p - a)); }, c);
  if (!(norm(normal) > flat * size * size && height > flat * size * norm(normal)))
    refuse(name, ": its ", points.size(), " points lie in one plane");
}

/// This is an edge of a triangle, which goes from `a` to `b`.
struct Side {
  std::uint32_t a, b, triangle;
  std::pair<std::uint32_t, std::uint32_t> edge() const { return std::minmax(a, b); }
};

void require_edges(const GroundMesh& mesh, const std::string& name) {
  const Array<std::uint32_t> first = weld(mesh.vertices);
  Array<Side> sides;
  for (std::uint32_t i = 0; i < mesh.triangles.size(); ++i)
    for (std::size_t k = 0; k < 3; ++k)
      sides.push_back({first[mesh.triangles[i][k]], first[mesh.triangles[i][(k + 1) % 3]], i});
  std::sort(sides.begin(), sides.end(), [](const Side& s, const Side& t) {
    return std::tuple(s.edge(), s.triangle) < std::tuple(t.edge(), t.triangle);
  });
  for (std::size_t k = 0; k < sides.size();) {
    std::size_t end = k + 1;
    while (end < sides.size() && sides[end].edge() == sides[k].edge()) ++end;
    const auto [a, b, triangle] = sides[k];
    if (end - k > 2)
      refuse(name, ": triangle ", sides[k + 2].triangle, " is the third at the edge of vertices ", a, " and ",
             b);
    if (mesh.solid && end - k == 1)
      refuse(name, ": triangle ", triangle, " has no neighbour at the edge of vertices ", a, " and ", b,
             ", so that it encloses nothing");
    if (mesh.solid && sides[k + 1].a == a)
      refuse(name, ": triangles ", triangle, " and ", sides[k + 1].triangle,
             " do not both go counterclockwise as seen from outside");
    k = end;
  }
}

void validate_mesh(const GroundMesh& mesh, std::size_t i) {
  const std::string name = "mesh " + std::to_string(i);
  validate_touch(mesh, name);
  if (mesh.triangles.empty()) refuse(name, ": has no triangles");
  for (std::size_t k = 0; k < mesh.vertices.size(); ++k)
    if (!is_finite(mesh.vertices[k])) refuse(name, ": vertex ", k, " is not finite: ", mesh.vertices[k]);
  double volume = 0;
  for (std::size_t k = 0; k < mesh.triangles.size(); ++k) {
    for (const std::uint32_t vertex : mesh.triangles[k])
      if (vertex >= mesh.vertices.size())
        refuse(name, ": triangle ", k, ": vertex ", vertex, " does not exist (the mesh has ",
               mesh.vertices.size(), " vertices)");
    const auto [a, b, c] = mesh.triangles[k];
    const Vec3 origin = mesh.vertices[mesh.triangles[0][0]], p = mesh.vertices[a] - origin;
    const Vec3 u = mesh.vertices[b] - origin - p, v = mesh.vertices[c] - origin - p, normal = cross(u, v);
    const double square = std::max({dot(u, u), dot(v, v), dot(u - v, u - v)});
    if (!(norm(normal) > no_area * square)) refuse(name, ": triangle ", k, " has no area");
    volume += dot(p, normal);
  }
  require_edges(mesh, name);
  if (mesh.solid && !(volume > 0)) refuse(name, ": its triangles go clockwise as seen from outside");
}

void validate_height_field(const HeightField& field, std::size_t i) {
  const std::string name = "height field " + std::to_string(i);
  validate_touch(field, name);
  if (!is_finite(field.corner)) refuse(name, ": corner is not finite: ", field.corner);
  for (const double cell : {field.cell_x, field.cell_z})
    if (!(cell > 0 && std::isfinite(cell)))
      refuse(name, ": cell size must be positive and finite, got ", cell, " m");
  if (field.columns < 2) refuse(name, ": has ", field.columns, " columns, but needs two");
  if (field.heights.size() % field.columns != 0 || field.heights.size() < 2 * std::size_t{field.columns})
    refuse(name, ": ", field.heights.size(), " heights are not two or more rows of ", field.columns);
  for (std::size_t k = 0; k < field.heights.size(); ++k)
    if (!std::isfinite(field.heights[k])) refuse(name, ": height ", k, " is not finite: ", field.heights[k]);
}

}  // namespace

void validate_surface(const Surface& surface, const std::string& name) {
  if (!(surface.friction >= 0 && std::isfinite(surface.friction)))
    refuse(name, ": friction must be finite and not negative, got ", surface.friction);
  if (!(surface.restitution >= 0 && surface.restitution <= 1))
    refuse(name, ": restitution must be from 0 to 1, got ", surface.restitution);
  for (const auto& [what, length] : {std::pair{"rolling", surface.rolling}, {"spinning", surface.spinning}})
    if (!(length >= 0 && std::isfinite(length)))
      refuse(name, ": ", what, " must be finite and not negative, got ", length, " m");
}

void validate_hulls(const Scene& scene) {
  for (std::size_t i = 0; i < scene.hulls.size(); ++i) {
    const Hull& hull = scene.hulls[i];
    const std::string name = "hull " + std::to_string(i);
    if (hull.body >= scene.bodies.size())
      refuse(name, ": body ", hull.body, " does not exist (the scene has ", scene.bodies.size(), " bodies)");
    require_amount(hull.radius, "radius", name);
    require_volume(hull.points, name);
    validate_touch(hull, name);
  }
}

void validate_ground(const Scene& scene) {
  for (std::size_t i = 0; i < scene.ground_capsules.size(); ++i) {
    const GroundCapsule& capsule = scene.ground_capsules[i];
    const std::string name = "ground capsule " + std::to_string(i);
    for (const Vec3 end : {capsule.a, capsule.b})
      if (!is_finite(end)) refuse(name, ": an end is not finite: ", end);
    require_amount(capsule.radius, "radius", name);
    validate_touch(capsule, name);
  }
  for (std::size_t i = 0; i < scene.ground_hulls.size(); ++i) {
    const GroundHull& hull = scene.ground_hulls[i];
    const std::string name = "ground hull " + std::to_string(i);
    require_amount(hull.radius, "radius", name);
    require_volume(hull.points, name);
    validate_touch(hull, name);
  }
  for (std::size_t i = 0; i < scene.meshes.size(); ++i) validate_mesh(scene.meshes[i], i);
  for (std::size_t i = 0; i < scene.height_fields.size(); ++i)
    validate_height_field(scene.height_fields[i], i);
}

}  // namespace plumb::detail
