#include "contact/shapes/meshes/touch_mesh.hpp"

#include <algorithm>
#include <cmath>

namespace plumb::detail {
namespace {

/// Two touches of one point are the same if their normals have this cosine.
constexpr double same_direction = 1 - 1e-10;
/// Places nearer than this share of a segment to its ends count as ends.
constexpr double at_end = 1e-9;
/// What is nearer than this (m) lies in the mesh and has no side of its own.
constexpr double no_side = 1e-12;

Bounds around(const Triangle& triangle) {
  Bounds out = nowhere;
  for (const Vec3 corner : triangle) include(out, corner, 0);
  return out;
}

/// Returns whether a triangle's plane is farther than `reach` (m) from a segment.
bool is_above_or_below(const TriangleMesh& mesh, std::uint32_t i, Vec3 p, Vec3 q, double reach) {
  const Vec3 n = mesh.normal(i), corner = mesh.vertex(mesh.vertices_of(i)[0]);
  const double at_p = dot(n, p - corner), at_q = dot(n, q - corner);
  return std::min(at_p, at_q) > reach || std::max(at_p, at_q) < -reach;
}

Bounds ball(Vec3 p, double radius) {
  Bounds out = nowhere;
  include(out, p, radius);
  return out;
}

/// Finds the touch of a point with one triangle, or none if another one is nearer there.
bool touch_triangle(const TriangleMesh& mesh, std::uint32_t i, Vec3 p, Vec3 middle, LineTouch& out) {
  const Triangle triangle = mesh.triangle(i);
  const TrianglePlace place = nearest_on(triangle, p);
  out.part = mesh.part(i, place.part);
  const Vec3 apart = p - place.at;
  const bool on_face = place.part == TrianglePart::face;
  const double height = on_face ? dot(mesh.normal(i), p - triangle[0]) : norm(apart);
  if (std::abs(height) > no_side) {
    out.normal = on_face ? std::copysign(1.0, height) * mesh.normal(i) : (1 / height) * apart;
    out.gap = std::abs(height);
  } else {
    const Vec3 n = mesh.normal(i);
    const bool turned = mesh.sides() == MeshSides::both && dot(n, middle - place.at) < 0;
    out.normal = turned ? -1.0 * n : n;
    out.gap = 0;
    return true;
  }
  return mesh.faces(out.part, out.normal);
}

/// Returns whether a triangle counts as the one that a line crosses. Of several that meet where it does so,
/// to the last bit, one does.
bool is_crossed(const TriangleMesh& mesh, std::uint32_t i, Vec3 p, Vec3 q) {
  const auto where = crossing(mesh.triangle(i), p, q);
  if (!where) return false;
  const MeshPart part = mesh.part(i, *where);
  return part.kind == MeshPart::Kind::face ||
         (part.kind == MeshPart::Kind::edge ? mesh.owner_of_edge(part.number)
                                            : mesh.owner_of_vertex(part.number)) == i;
}

/// Returns whether a mesh parts two places: a line between them crosses it an odd number of times.
bool parts(const TriangleMesh& mesh, Vec3 p, Vec3 q) {
  bool out = false;
  Bounds box = nowhere;
  include(box, p, 0);
  include(box, q, 0);
  mesh.find(box, [&](std::uint32_t i) { out = out != is_crossed(mesh, i, p, q); });
  return out;
}

/// Returns the triangle that a point is right below, however far, or none.
std::uint32_t right_above(const TriangleMesh& mesh, Vec3 p) {
  const Vec3 top{p.x, mesh.bounds().high.y + 1, p.z};
  std::uint32_t out = TriangleMesh::none;
  if (!(p.y < mesh.bounds().high.y)) return out;
  Bounds column = nowhere;
  include(column, p, 0);
  include(column, top, 0);
  mesh.find(column, [&](std::uint32_t i) {
    if (out == TriangleMesh::none && is_crossed(mesh, i, p, top)) out = i;
  });
  return out;
}

/// Adds that triangle.
void touch_above(const TriangleMesh& mesh, Vec3 p, double at, LineTouches& out) {
  const std::uint32_t i = right_above(mesh, p);
  if (i == TriangleMesh::none) return;
  const Vec3 n = mesh.normal(i);
  out.add({{MeshPart::Kind::face, i}, n, dot(n, p - mesh.triangle(i)[0]), at});
}

void turn(LineTouch& touch) {
  touch.normal = -1.0 * touch.normal;
  touch.gap = -touch.gap;
}

bool is_listed(const LineTouches& list, const LineTouch& touch) {
  return std::any_of(list.begin(), list.end(), [&](const LineTouch& other) {
    return other.part == touch.part || dot(other.normal, touch.normal) > same_direction;
  });
}

/// Adds a segment's touch with an edge, if both are nearest within themselves.
void touch_edge(const TriangleMesh& mesh, std::uint32_t number, const Segment& segment, double reach,
                LineTouches& out) {
  const TriangleMesh::Edge& edge = mesh.edge(number);
  if (edge.is_flat) return;
  const Segment side{mesh.vertex(edge.a), mesh.vertex(edge.b), 0};
  if (are_apart(segment, side, reach)) return;
  const Touch near = touch(segment, side);
  const auto is_inner = [](double t) { return t > at_end && t < 1 - at_end; };
  const MeshPart part{MeshPart::Kind::edge, number};
  if (near.gap > reach || near.gap <= no_side || !is_inner(near.a) || !is_inner(near.b)) return;
  if (!mesh.faces(part, near.normal) || mesh.leads_inside(part, near.normal)) return;
  out.add({part, near.normal, near.gap, near.a});
}

/// Adds a segment's touch with a vertex, if it is nearest within the segment.
void touch_vertex(const TriangleMesh& mesh, std::uint32_t number, const Segment& segment, double reach,
                  LineTouches& out) {
  const Vec3 vertex = mesh.vertex(number), along = segment.q - segment.p, from = vertex - segment.p;
  const double square = dot(along, along), way = dot(along, from);
  // Most vertices are far, which takes no root and no division to tell; rounding is far below the share.
  if (!(way > 0 && way < square)) return;
  if (dot(from, from) * square - way * way > 1.001 * reach * reach * square) return;
  const double at = way / square;
  if (!(at > at_end && at < 1 - at_end)) return;
  const Vec3 apart = between(segment.p, segment.q, at) - vertex;
  const double gap = norm(apart);
  if (gap > reach || gap <= no_side) return;
  const Vec3 n = (1 / gap) * apart;
  const MeshPart part{MeshPart::Kind::vertex, number};
  if (mesh.faces(part, n) && !mesh.leads_inside(part, n)) out.add({part, n, gap, at});
}

}  // namespace

void LineTouches::add(const LineTouch& touch) {
  if (count < most) {
    list[count++] = touch;
    return;
  }
  const auto widest = std::max_element(list.begin(), list.end(),
                                       [](const LineTouch& a, const LineTouch& b) { return a.gap < b.gap; });
  if (touch.gap < widest->gap) *widest = touch;
}

bool is_below(const TriangleMesh& mesh, Vec3 p) {
  return right_above(mesh, p) != TriangleMesh::none;
}

void touch_mesh(const TriangleMesh& mesh, Vec3 p, Vec3 middle, double reach, double at, LineTouches& out) {
  LineTouches own;
  LineTouch nearest{.gap = INFINITY};
  bool is_through = false;
  // The tree lists some triangles that are only near.
  const Bounds within = ball(p, reach);
  Bounds way = nowhere;
  include(way, middle, 0);
  include(way, p, 0);
  mesh.find(within, [&](std::uint32_t i) {
    const Triangle triangle = mesh.triangle(i);
    const Bounds bounds = around(triangle);
    if (mesh.sides() == MeshSides::both && !is_through && bounds.overlaps(way))
      is_through = crosses(triangle, middle, p);
    if (!bounds.overlaps(within) || is_above_or_below(mesh, i, p, p, reach)) return;
    LineTouch touch{.at = at};
    if (!touch_triangle(mesh, i, p, middle, touch) || touch.gap > reach) return;
    if (touch.gap < nearest.gap) nearest = touch;
    if (!mesh.leads_inside(touch.part, touch.normal) && !is_listed(own, touch)) own.add(touch);
  });
  if (mesh.encloses() && !(nearest.gap < INFINITY) && distance2(mesh.bounds(), p) == 0) {
    const TriangleMesh::Nearest far = mesh.nearest(p, norm(mesh.bounds().high - mesh.bounds().low));
    nearest = {.at = at};
    const bool is_found =
        far.triangle != TriangleMesh::none && touch_triangle(mesh, far.triangle, p, middle, nearest);
    is_through = is_found && mesh.leads_inside(nearest.part, nearest.normal);
  } else if (mesh.encloses() && nearest.gap < INFINITY) {
    is_through = mesh.leads_inside(nearest.part, nearest.normal);
  }
  if (mesh.sides() == MeshSides::both) is_through = is_through && parts(mesh, middle, p);
  // What lies in the surface is on its middle's side already.
  if (is_through && nearest.gap > 0 && nearest.gap < INFINITY) {
    turn(nearest);
    out.add(nearest);
    return;
  }
  for (const LineTouch& touch : own) out.add(touch);
  if (mesh.sides() == MeshSides::upward && own.count == 0) touch_above(mesh, p, at, out);
}

void touch_mesh_between(const TriangleMesh& mesh, Vec3 p, Vec3 q, double reach, LineTouches& out) {
  Bounds box = nowhere;
  include(box, p, reach);
  include(box, q, reach);
  mesh.find(box, [&](std::uint32_t i) {
    if (!around(mesh.triangle(i)).overlaps(box) || is_above_or_below(mesh, i, p, q, reach)) return;
    for (const std::uint32_t edge : mesh.edges_of(i))
      if (mesh.owner_of_edge(edge) == i) touch_edge(mesh, edge, {p, q, 0}, reach, out);
    for (const std::uint32_t vertex : mesh.vertices_of(i))
      if (mesh.owner_of_vertex(vertex) == i && !mesh.is_flat(vertex))
        touch_vertex(mesh, vertex, {p, q, 0}, reach, out);
  });
}

}  // namespace plumb::detail
