#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "plumb/export.hpp"
#include "plumb/vec3.hpp"

/// @file
/// This file holds the bounding volumes of thesis 2.3, from the cheapest to the tightest.
///
/// Each volume holds all points it was made of, to rounding. Lengths are in m and y is up. No points, or one
/// that is not finite, throw InputError with the number of the point. Volumes that touch overlap. Two that do
/// or do not by 1e-12 of their size may be taken either way.
namespace plumb {

/// This is a sphere about the mean of the points (thesis 2.3.1).
struct BoundingSphere {
  Vec3 center{};      ///< Centre, in m.
  double radius = 0;  ///< Radius, in m.
};
/// This is a cylinder that stands upright, whichever way its content is turned (thesis 2.3.2).
struct BoundingCylinder {
  Vec3 center{};      ///< Centre, in m.
  double radius = 0;  ///< Radius, in m.
  double height = 0;  ///< Height along y, in m.
};
/// This is a box between two corners, along the axes of space (thesis 2.3.3).
struct Aabb {
  Vec3 low{};   ///< Corner with the least coordinates, in m.
  Vec3 high{};  ///< Corner with the largest coordinates, in m.
};
/// This is a box along axes of its own: those along which the points spread most and least (thesis 2.3.4).
struct Obb {
  Vec3 center{};               ///< Centre, in m.
  std::array<Vec3, 3> axis{};  ///< Unit vectors at right angles.
  Vec3 half_size{};            ///< Half of its sides along these axes, in m.
};
/// This is the convex hull, the tightest of convex polygon meshes (thesis 2.3.5). Points may be outside by
/// 1e-9 of its size, so that those on a flat side do not cut it into slivers.
struct ConvexMesh {
  std::vector<Vec3> vertices;                       ///< Those points that are on the hull, in their order.
  std::vector<std::array<std::uint32_t, 3>> faces;  ///< Triangles, anticlockwise as seen from outside.
};

/// Returns the sphere about the mean of the points, as large as the farthest of them asks.
PLUMB_API BoundingSphere bounding_sphere_of(std::span<const Vec3> points);
/// Returns the upright cylinder about the mean of the points.
PLUMB_API BoundingCylinder bounding_cylinder_of(std::span<const Vec3> points);
/// Returns the least box along the axes of space.
PLUMB_API Aabb aabb_of(std::span<const Vec3> points);
/// Returns the box along the principal axes of the points.
PLUMB_API Obb obb_of(std::span<const Vec3> points);
/// Returns the convex hull, by quickhull (Barber, Dobkin, Huhdanpaa 1996). Throws InputError also if the
/// points lie in one plane, to 1e-9 of their size.
PLUMB_API ConvexMesh convex_mesh_of(std::span<const Vec3> points);

/// Returns whether two spheres overlap.
PLUMB_API bool overlap(const BoundingSphere& a, const BoundingSphere& b);
/// Returns whether two upright cylinders overlap.
PLUMB_API bool overlap(const BoundingCylinder& a, const BoundingCylinder& b);
/// Returns whether two boxes along the axes of space overlap.
PLUMB_API bool overlap(const Aabb& a, const Aabb& b);
/// Returns whether two boxes overlap, by the 15 axes that can separate them (Gottschalk, Lin, Manocha 1996).
/// The edges through faces of thesis 2.4.2 would miss a box inside another.
PLUMB_API bool overlap(const Obb& a, const Obb& b);
/// Returns whether two hulls overlap, by their distance (Gilbert, Johnson, Keerthi 1988). Two that all but
/// touch are decided by their separating axes, which costs a test for every pair of edges.
PLUMB_API bool overlap(const ConvexMesh& a, const ConvexMesh& b);

/// Holds a sphere to ask first and a box to ask then (thesis 2.4).
struct TwoLevels {
  BoundingSphere sphere{};  ///< The sphere that is asked first.
  Obb box{};                ///< The box that is asked then.
};
/// Returns both volumes of a set of points.
PLUMB_API TwoLevels two_levels_of(std::span<const Vec3> points);
/// Returns whether the boxes overlap. They are asked only if the spheres overlap.
PLUMB_API bool overlap_in_two_levels(const TwoLevels& a, const TwoLevels& b);

}  // namespace plumb
