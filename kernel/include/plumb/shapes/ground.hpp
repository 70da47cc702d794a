#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "plumb/shapes/surface.hpp"
#include "plumb/vec3.hpp"

/// @file
/// This file lists ground: what shapes touch and do not push away. Planes and boxes may move, and the other
/// solids and surfaces do not. validate() says what is refused of them.
namespace plumb {

/// This is solid ground: everything with normal·x < offset.
struct Plane {
  Vec3 normal{0, 1, 0};   ///< Unit vector out of the ground.
  double offset = 0;      ///< Distance of the surface from the origin along the normal, in m.
  Surface surface{};      ///< How it feels.
  Filter filter{};        ///< What it may touch.
  GroundMotion motion{};  ///< How it moves.
};

/// This is a solid box of the ground.
struct Box {
  Vec3 center{};                                  ///< Centre, in m.
  Vec3 half_size{};                               ///< Half of its sides, in m.
  std::array<double, 4> orientation{1, 0, 0, 0};  ///< Unit quaternion w, x, y, z.
  Surface surface{};                              ///< How it feels.
  Filter filter{};                                ///< What it may touch.
  GroundMotion motion{};                          ///< How it moves.
};

/// This is a solid capsule: all that is within `radius` of the line from a to b. It is a sphere if they are
/// the same.
struct GroundCapsule {
  Vec3 a{};           ///< One end of the line, in m.
  Vec3 b{};           ///< The other end, in m.
  double radius = 0;  ///< Radius, in m.
  Surface surface{};  ///< How it feels.
  Filter filter{};    ///< What it may touch.
};

/// This is a rounded convex solid: all that is within `radius` of the convex hull of points.
struct GroundHull {
  std::vector<Vec3> points{};  ///< Points, in m, which do not lie in one plane. Some may lie within the hull.
  double radius = 0;           ///< Radius of its edges and corners, in m.
  Surface surface{};           ///< How it feels.
  Filter filter{};             ///< What it may touch.
};

/// This is a surface of triangles, or the solid that it encloses.
///
/// An open surface is a thin sheet and is touched from both sides: it pushes towards the side that the middle
/// of a shape is on. A solid pushes out, even what starts inside. It may be concave, and may consist of
/// several parts. Vertices in the same place count as one.
struct GroundMesh {
  std::vector<Vec3> vertices{};                           ///< Places, in m.
  std::vector<std::array<std::uint32_t, 3>> triangles{};  ///< Indices into `vertices`.
  /// Whether it is a solid. Every edge then has two triangles, whose vertices go counterclockwise as seen
  /// from outside.
  bool solid = false;
  Surface surface{};  ///< How it feels.
  Filter filter{};    ///< What it may touch.
};

/// This is a landscape: heights over a rectangular grid along x and z, and all below is solid, 1000 km deep.
///
/// Every cell is two triangles, which meet along the line from its corner of least x and z to the opposite
/// one.
struct HeightField {
  Vec3 corner{};                  ///< Where height 0 is above the corner of least x and z, in m.
  double cell_x = 1;              ///< Distance of columns along x, in m.
  double cell_z = 1;              ///< Distance of rows along z, in m.
  std::uint32_t columns = 0;      ///< Heights in a row, at least 2.
  std::vector<double> heights{};  ///< Heights above the corner, along y, in m, one row after the other.
  Surface surface{};              ///< How it feels.
  Filter filter{};                ///< What it may touch.
};

}  // namespace plumb
