#pragma once

#include <array>
#include <cstdint>

#include "contact/shapes/meshes/triangle_mesh.hpp"

namespace plumb::detail {

/// Says where the line of a shape, without its radius, is near a mesh.
struct LineTouch {
  MeshPart part{};  ///< of the mesh
  Vec3 normal{};    ///< unit vector from the mesh to the shape
  double gap = 0;   ///< m, of the line; if negative, it is on the wrong side
  double at = 0;    ///< place along the line, from 0 to 1
};

/// Holds the touches of one shape. If there are more than it has room for, the widest gaps are left out.
struct LineTouches {
  static constexpr std::uint32_t most = 32;
  std::array<LineTouch, most> list;
  std::uint32_t count = 0;

  void add(const LineTouch& touch);
  const LineTouch* begin() const { return list.data(); }
  const LineTouch* end() const { return list.data() + count; }
};

/// Lists where a mesh is nearest to a point, within neighbourhoods, as far as `reach` (m). The point is at
/// the place `at` of a shape with its middle at `middle`.
///
/// The mesh pushes towards the side of `middle`, or out of what it encloses. If it encloses the point, only
/// the nearest place counts, however far it is.
void touch_mesh(const TriangleMesh& mesh, Vec3 p, Vec3 middle, double reach, double at, LineTouches& out);

/// Returns whether a place is right below some triangle of a mesh.
bool is_below(const TriangleMesh& mesh, Vec3 p);

/// Lists where a segment is kept off a mesh between its ends: over edges that are not flat, and over
/// vertices.
void touch_mesh_between(const TriangleMesh& mesh, Vec3 p, Vec3 q, double reach, LineTouches& out);

}  // namespace plumb::detail
