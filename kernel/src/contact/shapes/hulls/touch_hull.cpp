#include "contact/shapes/hulls/touch_hull.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include "contact/shapes/meshes/touch_mesh.hpp"

namespace plumb::detail {
namespace {

/// An edge of the hull is kept off one of a mesh if the cosine of none of its faces, along the face, is
/// farther below 0. A sharp edge of the hull that lies along a ridge is so kept off at both of its ends,
/// around each of which it would else turn the other one in.
constexpr double lean = 0.1;

/// Gathers contacts. When there is no more room, they are thinned out.
class Contacts {
 public:
  Contacts(double radius, double reach) : radius_(radius), reach_(reach) {}

  void add(double distance, Vec3 normal, Vec3 on_hull, std::uint64_t key) {
    if (distance - radius_ > reach_) return;
    if (count_ == list_.size()) count_ = spread(list_);
    list_[count_++] = {distance - radius_, normal, on_hull, on_hull - distance * normal, key};
  }
  /// Returns the distance (m) of the hull's vertices beyond which nothing counts.
  double farthest() const { return reach_ + radius_; }
  ConvexContacts list() {
    ConvexContacts out;
    out.count = spread({list_.data(), count_});
    std::copy_n(list_.begin(), out.count, out.list.begin());
    return out;
  }

 private:
  std::array<ConvexContact, 96> list_;
  std::size_t count_ = 0;
  double radius_, reach_;
};

/// Keys of contacts say what touches: a corner of the hull, a vertex of the mesh, or an edge of either.
/// Touches of a corner go by their order: one that slides from triangle to triangle stays the same contact.
enum class Key : std::uint64_t { corner, vertex, edges };
std::uint64_t key_of(Key kind, std::uint64_t first, std::uint64_t second = 0) {
  return static_cast<std::uint64_t>(kind) << 62 | first << 34 | second;
}

struct Pair {
  const Convex& hull;
  Vec3 middle;
  const TriangleMesh& mesh;
};

/// Returns how far a point is above the face that it is highest above; that is less than 0 inside.
std::pair<std::uint32_t, double> highest_above(const Convex& hull, Vec3 p) {
  std::pair<std::uint32_t, double> out{0, -INFINITY};
  for (std::uint32_t i = 0; i < hull.faces(); ++i) {
    const double height = dot(hull.normals[i], p - hull.vertices[hull.parts->face(i)[0]]);
    if (height > out.second) out = {i, height};
  }
  return out;
}

/// Returns whether a segment comes into the hull, or as near to all its faces as `slack` (m).
bool comes_into(const Convex& hull, const Segment& line, double slack) {
  double from = 0, to = 1;
  for (std::uint32_t i = 0; i < hull.faces(); ++i) {
    const Vec3 corner = hull.vertices[hull.parts->face(i)[0]];
    const double at_p = dot(hull.normals[i], line.p - corner) - slack;
    const double at_q = dot(hull.normals[i], line.q - corner) - slack;
    if (at_p > 0 && at_q > 0) return false;
    if (at_p > 0) from = std::max(from, at_p / (at_p - at_q));
    if (at_q > 0) to = std::min(to, at_p / (at_p - at_q));
  }
  return from <= to;
}

/// What comes into the hull is pushed out to the side where the hull's middle is not. An edge of the mesh may
/// do so elsewhere than where it is pushed: beside a sharp edge of the hull that place is outside. Places on
/// the surface are inside to rounding.
bool is_sound(const Pair& pair, double distance, Vec3 normal, Vec3 on_mesh, const Segment& part) {
  return distance >= 0 ||
         (dot(normal, pair.middle - on_mesh) > 0 && comes_into(pair.hull, part, -0.1 * distance));
}

/// A vertex of the mesh counts where it is nearest to the hull. Inside it counts for the face that it is
/// least below.
void add_vertex(const Pair& pair, std::uint32_t number, Contacts& out) {
  const Vec3 vertex = pair.mesh.vertex(number);
  const auto [face, height] = highest_above(pair.hull, vertex);
  if (height > out.farthest()) return;
  double distance = height;
  Vec3 n = -1.0 * pair.hull.normals[face];
  if (height > 0) {
    const Nearness near = nearness(pair.hull, {.vertices = {&vertex, 1}, .normals = {}});
    distance = near.distance;
    n = near.normal;
  }
  const MeshPart part{MeshPart::Kind::vertex, number};
  if (!pair.mesh.faces(part, n) || pair.mesh.leads_inside(part, n)) return;
  if (is_sound(pair, distance, n, vertex, {vertex, vertex, 0}))
    out.add(distance, n, vertex + distance * n, key_of(Key::vertex, number));
}

/// Two edges count where they cross and both shapes are on their own sides of the plane along both.
void add_edges(const Pair& pair, std::uint32_t number, std::uint32_t of_hull, Contacts& out) {
  const TriangleMesh::Edge& edge = pair.mesh.edge(number);
  const Convex& hull = pair.hull;
  const ConvexParts::Edge& own = hull.parts->edges[of_hull];
  const Segment one{hull.vertices[own.a], hull.vertices[own.b], 0};
  const Segment other{pair.mesh.vertex(edge.a), pair.mesh.vertex(edge.b), 0};
  const Vec3 along = one.q - one.p, across = cross(along, other.q - other.p);
  const double size = norm(across);
  if (!(size > 1e-6 * norm(along) * norm(other.q - other.p))) return;
  const Vec3 left = cross(hull.normals[own.left], along), right = cross(along, hull.normals[own.right]);
  for (const double sign : {1.0, -1.0}) {
    const Vec3 n = (sign / size) * across;
    const double least = -lean * norm(along);
    if (dot(n, left) < least || dot(n, right) < least) continue;
    const MeshPart part{MeshPart::Kind::edge, number};
    if (!pair.mesh.faces(part, n) || pair.mesh.leads_inside(part, n)) continue;
    const Touch near = touch(one, other);
    if (!(near.a > 0 && near.a < 1 && near.b > 0 && near.b < 1)) return;
    const Vec3 at = between(one.p, one.q, near.a), on_mesh = between(other.p, other.q, near.b);
    const double gap = dot(n, at - on_mesh);
    if (is_sound(pair, gap, n, on_mesh, other)) out.add(gap, n, at, key_of(Key::edges, of_hull, number));
    return;
  }
}

}  // namespace

ConvexContacts contacts_of(const Convex& hull, Vec3 middle, const TriangleMesh& mesh, double reach) {
  Contacts out(hull.radius, reach);
  const double around = reach + hull.radius;
  Bounds box = nowhere;
  for (std::uint32_t i = 0; i < hull.vertices.size(); ++i) {
    const Vec3 p = hull.vertices[i];
    include(box, p, around);
    LineTouches touches;
    touch_mesh(mesh, p, middle, around, 0, touches);
    for (std::uint32_t k = 0; k < touches.count; ++k)
      out.add(touches.list[k].gap, touches.list[k].normal, p, key_of(Key::corner, i, k));
  }
  const Pair pair{hull, middle, mesh};
  mesh.find(box, [&](std::uint32_t i) {
    for (const std::uint32_t vertex : mesh.vertices_of(i))
      if (mesh.owner_of_vertex(vertex) == i && !mesh.is_flat(vertex) && hull.faces() > 0)
        add_vertex(pair, vertex, out);
    for (const std::uint32_t edge : mesh.edges_of(i)) {
      if (mesh.owner_of_edge(edge) != i || mesh.edge(edge).is_flat || hull.faces() == 0) continue;
      Bounds around_edge = nowhere;
      include(around_edge, mesh.vertex(mesh.edge(edge).a), 0);
      include(around_edge, mesh.vertex(mesh.edge(edge).b), 0);
      if (!box.overlaps(around_edge)) continue;
      for (std::uint32_t k = 0; k < hull.parts->edges.size(); ++k) add_edges(pair, edge, k, out);
    }
  });
  return out.list();
}

}  // namespace plumb::detail
