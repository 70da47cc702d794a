#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "plumb/export.hpp"
#include "plumb/vec3.hpp"

/// Bounding volumes of thesis 2.3, from the cheapest to the tightest. Each holds all points it was made of,
/// to rounding; lengths in m, y is up. Made of no points, or of one that is not finite, they throw InputError
/// with the number of the point. Volumes that touch overlap; two that do or do not by 1e-12 of their size may
/// be taken either way.
namespace plumb {

/// About the mean of the points (thesis 2.3.1).
struct BoundingSphere {
  Vec3 center{};
  double radius = 0;
};
/// Upright, whichever way its content is turned (thesis 2.3.2).
struct BoundingCylinder {
  Vec3 center{};
  double radius = 0;
  double height = 0;
};
/// Between two corners, along the axes of space (thesis 2.3.3).
struct Aabb {
  Vec3 low{}, high{};
};
/// Along axes of its own: those along which the points spread most and least (thesis 2.3.4).
struct Obb {
  Vec3 center{};
  std::array<Vec3, 3> axis{};  ///< of length one, at right angles
  Vec3 half_size{};            ///< along each axis
};
/// The convex hull: the tightest of convex polygon meshes (thesis 2.3.5). Points may be outside by 1e-9 of
/// its size, so that those on a flat side do not cut it into slivers.
struct ConvexMesh {
  std::vector<Vec3> vertices;                       ///< of the points, those on the hull, in their order
  std::vector<std::array<std::uint32_t, 3>> faces;  ///< triangles, anticlockwise as seen from outside
};

PLUMB_API BoundingSphere bounding_sphere_of(std::span<const Vec3> points);
PLUMB_API BoundingCylinder bounding_cylinder_of(std::span<const Vec3> points);
PLUMB_API Aabb aabb_of(std::span<const Vec3> points);
PLUMB_API Obb obb_of(std::span<const Vec3> points);
/// By quickhull (Barber, Dobkin, Huhdanpaa 1996). Throws InputError also if the points lie in one plane, to
/// 1e-9 of their size.
PLUMB_API ConvexMesh convex_mesh_of(std::span<const Vec3> points);

PLUMB_API bool overlap(const BoundingSphere& a, const BoundingSphere& b);
PLUMB_API bool overlap(const BoundingCylinder& a, const BoundingCylinder& b);
PLUMB_API bool overlap(const Aabb& a, const Aabb& b);
/// By the 15 axes that can separate two boxes (Gottschalk, Lin, Manocha 1996), instead of the edges through
/// faces of thesis 2.4.2, which miss a box inside another.
PLUMB_API bool overlap(const Obb& a, const Obb& b);
/// By the distance of the two (Gilbert, Johnson, Keerthi 1988); of two that all but touch, by their
/// separating axes, which takes as many times longer as they have pairs of edges.
PLUMB_API bool overlap(const ConvexMesh& a, const ConvexMesh& b);

/// A sphere to ask first and a box to ask then (thesis 2.4).
struct TwoLevels {
  BoundingSphere sphere{};
  Obb box{};
};
PLUMB_API TwoLevels two_levels_of(std::span<const Vec3> points);
/// Whether the boxes overlap, which is asked only if the spheres do.
PLUMB_API bool overlap_in_two_levels(const TwoLevels& a, const TwoLevels& b);

}  // namespace plumb
