#include "contact/ground/ground_shape.hpp"

#include <algorithm>
#include <utility>
#include <vector>

#include "plumb/joints.hpp"

namespace plumb::detail {

GroundMesh mesh_of(const HeightField& field) {
  GroundMesh out{.solid = true, .surface = field.surface, .filter = field.filter};
  const std::uint32_t columns = field.columns;
  const auto rows = static_cast<std::uint32_t>(field.heights.size() / columns);
  for (std::uint32_t k = 0; k < rows; ++k)
    for (std::uint32_t i = 0; i < columns; ++i)
      out.vertices.push_back(field.corner + Vec3{i * field.cell_x,
                                                 field.heights[std::size_t{k} * columns + i],
                                                 k * field.cell_z});
  for (std::uint32_t k = 0; k + 1 < rows; ++k)
    for (std::uint32_t i = 0; i + 1 < columns; ++i) {
      const std::uint32_t near = k * columns + i, far = near + columns;
      out.triangles.push_back({near, far, far + 1});
      out.triangles.push_back({near, far + 1, near + 1});
    }
  return out;
}

ConvexHull unit_cube() {
  return ConvexHull(box_on_body(0, {.half_size = {1, 1, 1}}).points);
}

namespace {

/// A box may be thinner than the hull of any points.
ConvexHull hull_of(const Box& box) {
  const std::vector<Vec3> points = box_on_body(0, box).points;
  const ConvexHull hull = unit_cube();
  Array<Vec3> corners;
  for (const std::uint32_t number : hull.numbers()) corners.push_back(points[number]);
  return hull.moved_to(corners);
}

template <class Touch>
std::optional<Touch> unless_at_start(const std::optional<Touch>& touch) {
  return touch && touch->time > 0 ? touch : std::nullopt;
}

}  // namespace

GroundShape::GroundShape(const Box& box, std::uint32_t number)
    : hull_(hull_of(box)),
      bounds_(hull_.bounds()),
      surface_(box.surface),
      filter_(box.filter),
      box_(number) {}

GroundShape::GroundShape(const GroundCapsule& capsule)
    : line_{capsule.a},
      radius_(capsule.radius),
      bounds_(nowhere),
      surface_(capsule.surface),
      filter_(capsule.filter) {
  if (capsule.b != capsule.a) line_.push_back(capsule.b);
  for (const Vec3 end : line_) include(bounds_, end, radius_);
}

GroundShape::GroundShape(const GroundHull& hull)
    : hull_(hull.points),
      radius_(hull.radius),
      bounds_(nowhere),
      surface_(hull.surface),
      filter_(hull.filter) {
  for (const Vec3 v : hull_.vertices()) include(bounds_, v, radius_);
}

GroundShape::GroundShape(const GroundMesh& mesh)
    : GroundShape(mesh, mesh.solid ? MeshSides::outward : MeshSides::both) {}

GroundShape::GroundShape(const GroundMesh& mesh, MeshSides sides)
    : mesh_(std::in_place, mesh.vertices, mesh.triangles, sides),
      bounds_(mesh_->bounds()),
      surface_(mesh.surface),
      filter_(mesh.filter) {}

GroundShape::GroundShape(const HeightField& field) : GroundShape(mesh_of(field), MeshSides::upward) {
  bounds_.low.y -= depth_of_fields;
}

Convex GroundShape::convex() const {
  return hull_.is_empty() ? Convex{.vertices = line_, .normals = {}, .radius = radius_}
                          : hull_.shape(radius_);
}

bool GroundShape::reaches_into(const Bounds& bounds) const {
  if (!bounds_.overlaps(bounds)) return false;
  return !mesh_ || mesh_->encloses() || mesh_->reaches_into(bounds);
}

bool GroundShape::encloses(Vec3 p) const {
  if (!mesh_ || !mesh_->encloses()) return false;
  LineTouches touches;
  touch_mesh(*mesh_, p, p, 0, 0, touches);
  return touches.count > 0 && touches.list[0].gap < 0;
}

void GroundShape::touch_point(Vec3 p, Vec3 middle, double reach, LineTouches& out) const {
  if (mesh_) {
    touch_mesh(*mesh_, p, middle, reach, 0, out);
    return;
  }
  const Nearness near = nearness({.vertices = {&p, 1}, .normals = {}}, convex());
  if (near.distance - radius_ <= reach) out.add({.normal = near.normal, .gap = near.distance - radius_});
}

namespace {

/// Returns whether all of a line is straight above one face of a solid. It touches that at its ends alone.
bool lies_over_a_face(const Convex& solid, Vec3 p, Vec3 q) {
  const auto is_over = [&](std::uint32_t face) {
    const auto corners = solid.parts->face(face);
    const Vec3 n = solid.normals[face];
    Vec3 last = solid.vertices[corners.back()];
    if (dot(n, p - last) <= 0 || dot(n, q - last) <= 0) return false;
    return std::all_of(corners.begin(), corners.end(), [&](std::uint32_t corner) {
      const Vec3 here = solid.vertices[corner], out = cross(here - std::exchange(last, here), n);
      return dot(out, p - here) < 0 && dot(out, q - here) < 0;
    });
  };
  for (std::uint32_t face = 0; face < solid.faces(); ++face)
    if (is_over(face)) return true;
  return false;
}

}  // namespace

void GroundShape::touch_between(Vec3 p, Vec3 q, double reach, LineTouches& out) const {
  if (mesh_) {
    touch_mesh_between(*mesh_, p, q, reach, out);
    return;
  }
  const Convex solid = convex();
  if (lies_over_a_face(solid, p, q)) return;
  const std::array<Vec3, 2> line{p, q};
  for (const ConvexContact& each : contacts_of({.vertices = line, .normals = {}}, solid, reach)) {
    constexpr double at_end = 1e-3;  // touch_point() finds what is at the ends
    const double at = place_along(p, q, each.on_a);
    if (at > at_end && at < 1 - at_end) out.add({.normal = each.normal, .gap = each.gap, .at = at});
  }
}

ConvexContacts GroundShape::touch_hull(const Convex& hull, Vec3 middle, double reach) const {
  return mesh_ ? contacts_of(hull, middle, *mesh_, reach) : contacts_of(hull, convex(), reach);
}

std::optional<FirstTouch> GroundShape::first_touch(const MovingSegment& moving, double close) const {
  return unless_at_start(mesh_ ? sweep(moving, *mesh_, close) : sweep(moving, convex(), close));
}

std::optional<FirstHullTouch> GroundShape::first_touch(const MovingHull& moving, double close) const {
  return unless_at_start(mesh_ ? sweep(moving, *mesh_, close) : sweep(moving, convex(), close));
}

}  // namespace plumb::detail
