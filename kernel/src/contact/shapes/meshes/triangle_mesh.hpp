#pragma once

#include <array>
#include <cstdint>
#include <span>

#include "contact/shapes/bounds_tree.hpp"
#include "contact/shapes/meshes/triangle.hpp"
#include "plumb/layouts/memory.hpp"

namespace plumb::detail {

/// Says which way the triangles of a mesh push: to the side where something is, out of what they enclose, or
/// out of that and of all below them.
enum class MeshSides : std::uint8_t { both, outward, upward };

/// This is a part of a mesh: a vertex, an edge or a triangle.
struct MeshPart {
  enum class Kind : std::uint8_t { vertex, edge, face };
  Kind kind = Kind::face;
  std::uint32_t number = 0;

  friend bool operator==(const MeshPart&, const MeshPart&) = default;
};

/// Holds triangles, how they hang together, and a hierarchy of bounding volumes around them.
///
/// A place of the mesh is where it is nearest to something, within some neighbourhood, if no direction along
/// the mesh leads nearer. faces() says so for its parts: places inside of triangles always are; those on
/// edges and vertices only if no triangle around them leans towards what is near.
class TriangleMesh {
 public:
  using Corners = std::array<std::uint32_t, 3>;
  struct Edge {
    std::uint32_t a, b;         ///< vertices
    std::uint32_t triangle[2];  ///< the second one is `none` on a border
    Vec3 inward[2];             ///< unit vectors across the edge, along each triangle
    bool is_flat;               ///< both triangles lie in one plane, to `flat`
  };
  static constexpr std::uint32_t none = 0xffffffff;

  TriangleMesh(std::span<const Vec3> vertices, std::span<const Corners> triangles, MeshSides sides);

  MeshSides sides() const { return sides_; }
  bool encloses() const { return sides_ != MeshSides::both; }
  Bounds bounds() const { return tree_.bounds(); }
  std::uint32_t size() const { return static_cast<std::uint32_t>(triangles_.size()); }
  Triangle triangle(std::uint32_t i) const {
    return {vertices_[triangles_[i][0]], vertices_[triangles_[i][1]], vertices_[triangles_[i][2]]};
  }
  Vec3 normal(std::uint32_t triangle) const { return normals_[triangle]; }
  Vec3 vertex(std::uint32_t i) const { return vertices_[i]; }
  const Edge& edge(std::uint32_t i) const { return edges_[i]; }
  /// Returns the numbers of a triangle's vertices, and of its edges: from each vertex to the next.
  const Corners& vertices_of(std::uint32_t triangle) const { return triangles_[triangle]; }
  const Corners& edges_of(std::uint32_t triangle) const { return edges_of_[triangle]; }
  /// Returns the number of the triangle that stands for an edge or a vertex, where each is to be met once.
  std::uint32_t owner_of_edge(std::uint32_t edge) const { return edges_[edge].triangle[0]; }
  std::uint32_t owner_of_vertex(std::uint32_t vertex) const { return owners_[vertex]; }
  /// Returns whether all triangles around a vertex lie in one plane.
  bool is_flat(std::uint32_t vertex) const { return is_flat_[vertex] != 0; }
  /// Returns the part of the mesh that a part of a triangle is.
  MeshPart part(std::uint32_t triangle, TrianglePart of) const;

  /// Returns whether a place on a part is nearest, within its neighbourhood, to what lies from it along the
  /// unit vector n.
  bool faces(MeshPart part, Vec3 n) const;
  /// Returns whether no triangle around a vertex rises against the unit vector n.
  bool is_peak(std::uint32_t vertex, Vec3 n) const;
  /// Returns whether the unit vector n, out of a part at the place that is nearest to something, leads into
  /// what an outward mesh encloses. Borders enclose nothing.
  bool leads_inside(MeshPart part, Vec3 n) const;
  /// Returns the direction in which a part pushes, if it faces outward. It is the normal of the triangles
  /// around it, each weighted by its angle there (Baerentzen and Aanaes 2005).
  Vec3 outward(MeshPart part) const;

  /// Calls `found(triangle)` for all triangles near a box, always in the same order.
  template <class Found>
  void find(const Bounds& bounds, Found&& found) const {
    tree_.find(bounds, found);
  }
  /// Calls `met(triangle)` for all triangles that a box may meet within `best` (m) while it goes along a unit
  /// vector, about from near to far. `met` may lower `best`.
  template <class Met>
  void find_along(const Bounds& start, Vec3 along, double& best, Met&& met) const {
    tree_.find_along(start, along, best, met);
  }
  /// Returns whether some triangle may reach into a box.
  bool reaches_into(const Bounds& bounds) const { return tree_.reaches_into(bounds); }
  struct Nearest {
    std::uint32_t triangle = none;
    TrianglePlace place{};
    double distance = 0;  ///< m
  };
  /// Finds the nearest place to a point that is not farther than `most` (m). Of equally near triangles any is
  /// taken, but always the same.
  Nearest nearest(Vec3 p, double most) const;

 private:
  void connect();
  void weigh();

  Array<Vec3> vertices_;
  Array<Corners> triangles_, edges_of_;
  Array<Vec3> normals_;
  Array<Edge> edges_;
  Array<std::uint32_t> first_spoke_;         ///< by vertex, and the end
  Array<Vec3> spokes_;                       ///< unit vectors along edges out of vertices
  Array<Vec3> outward_;                      ///< by vertex
  Array<std::uint32_t> owners_;              ///< by vertex
  Array<std::uint8_t> on_border_, is_flat_;  ///< by vertex
  BoundsTree tree_;
  MeshSides sides_;
};

}  // namespace plumb::detail
