#include "queries/near_things.hpp"

#include <algorithm>

#include "contact/ground/ground_shape.hpp"
#include "contact/shapes/meshes/touch_mesh.hpp"
#include "contact/shapes/sweep.hpp"

namespace plumb::detail {
namespace {

/// What is nearer than this (m) lies in a surface and has no side of its own.
constexpr double no_side = 1e-12;

/// Returns a unit vector across another vector, which may be zero.
Vec3 across(Vec3 v) {
  const Vec3 out = cross(v, std::abs(v.x) < 0.6 * norm(v) ? Vec3{1, 0, 0} : Vec3{0, 1, 0});
  return norm(out) > 0 ? (1 / norm(out)) * out : Vec3{0, 1, 0};
}

/// Returns whether a mesh encloses a place whose nearest place on it is known.
bool encloses(const TriangleMesh& mesh, Vec3 place, const TriangleMesh::Nearest& near) {
  if (mesh.sides() == MeshSides::both) return false;
  // Borders of a landscape enclose what is below, however far they are aside.
  if (mesh.sides() == MeshSides::upward)
    return place.y > mesh.bounds().low.y - depth_of_fields && is_below(mesh, place);
  const Vec3 out = place - near.place.at;
  return mesh.leads_inside(mesh.part(near.triangle, near.place.part), (1 / near.distance) * out);
}

/// Returns the normal of a triangle to the side where a place is, or that of a mesh with a front.
Vec3 normal_to(const TriangleMesh& mesh, std::uint32_t triangle, Vec3 place) {
  const Vec3 n = mesh.normal(triangle);
  const bool is_turned = !mesh.encloses() && dot(n, place - mesh.triangle(triangle)[0]) < 0;
  return is_turned ? -1.0 * n : n;
}

Strike at_start(const Strike& near, double radius) {
  return near.distance <= radius ? Strike{0, near.normal, near.point} : Strike{};
}

}  // namespace

Strike near_capsule(Vec3 place, Vec3 p, Vec3 q, double radius) {
  const Vec3 on_line = between(p, q, place_along(p, q, place)), apart = place - on_line;
  const double distance = norm(apart);
  const Vec3 normal = distance > no_side ? (1 / distance) * apart : across(q - p);
  return {distance - radius, normal, on_line + radius * normal};
}

Strike near_plane(Vec3 place, const PlaneNow& plane) {
  const double distance = dot(plane.normal, place) - plane.offset;
  return {distance, plane.normal, place - distance * plane.normal};
}

Strike near_convex(Vec3 place, const Convex& shape) {
  const Nearness near = nearness({.vertices = {&place, 1}, .normals = {}}, shape);
  return {near.distance - shape.radius, near.normal, near.on_b + shape.radius * near.normal};
}

Strike near_mesh(Vec3 place, const TriangleMesh& mesh, double most) {
  TriangleMesh::Nearest near = mesh.nearest(place, most);
  if (near.triangle == TriangleMesh::none && mesh.encloses()) {
    Bounds reached = mesh.bounds();
    if (mesh.sides() == MeshSides::upward) reached.low.y -= depth_of_fields;
    if (distance2(reached, place) == 0) near = mesh.nearest(place, INFINITY);
  }
  if (near.triangle == TriangleMesh::none) return {};
  if (near.distance <= no_side) return {0, normal_to(mesh, near.triangle, place), near.place.at};
  const bool is_inside = encloses(mesh, place, near);
  if (!is_inside && near.distance > most) return {};
  const double distance = is_inside ? -near.distance : near.distance;
  return {distance, (1 / distance) * (place - near.place.at), near.place.at};
}

Strike near_thing(Vec3 place, const Things& things, const Thing& thing, double most) {
  if (thing.form == Thing::Form::capsule) return near_capsule(place, thing.p, thing.q, thing.radius);
  if (thing.form == Thing::Form::mesh) return near_mesh(place, things.mesh(thing), most);
  std::array<Vec3, 2> ends;
  return near_convex(place, things.convex(thing, ends));
}

Strike overlap(const Probe& probe, const PlaneNow& plane) {
  if (!probe.box) return at_start(near_plane(probe.origin, plane), probe.radius);
  Strike lowest;
  for (const Vec3 corner : probe.box->shape().vertices)
    if (const Strike each = near_plane(corner, plane); each.distance < lowest.distance) lowest = each;
  return at_start(lowest, 0);
}

Strike overlap(const Probe& probe, const Convex& shape) {
  if (!probe.box) return at_start(near_convex(probe.origin, shape), probe.radius);
  const Nearness near = nearness(probe.box->shape(), shape);
  if (near.distance > shape.radius) return {};
  return {0, near.normal, near.on_b + shape.radius * near.normal};
}

Strike overlap(const Probe& probe, const TriangleMesh& mesh) {
  if (!probe.box) return at_start(near_mesh(probe.origin, mesh, probe.radius), probe.radius);
  // A box that no triangle reaches into is inside or outside as a whole.
  if (const Strike inside = near_mesh(probe.origin, mesh, 0)) return at_start(inside, 0);
  const Vec3 reach = probe.reach();
  Strike first;
  std::uint32_t at = TriangleMesh::none;
  mesh.find({probe.origin - reach, probe.origin + reach}, [&](std::uint32_t i) {
    const Triangle triangle = mesh.triangle(i);
    if (i > at) return;
    const Nearness near = nearness(probe.box->shape(), {.vertices = triangle, .normals = {}});
    if (near.distance > 0) return;
    at = i;
    first = {0, normal_to(mesh, i, probe.origin), nearest_on(triangle, probe.origin).at};
  });
  return first;
}

Strike overlap(const Probe& probe, const Things& things, const Thing& thing) {
  if (thing.form == Thing::Form::mesh) return overlap(probe, things.mesh(thing));
  if (thing.form == Thing::Form::capsule && !probe.box)
    return at_start(near_capsule(probe.origin, thing.p, thing.q, thing.radius), probe.radius);
  std::array<Vec3, 2> ends;
  return overlap(probe, things.convex(thing, ends));
}

}  // namespace plumb::detail
