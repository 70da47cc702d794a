#pragma once

#include <optional>

#include "contact/shapes/hulls/convex_hull.hpp"
#include "contact/shapes/hulls/touch_hull.hpp"
#include "contact/shapes/meshes/touch_mesh.hpp"
#include "contact/shapes/sweep.hpp"
#include "plumb/layouts/memory.hpp"
#include "plumb/scene.hpp"
#include "plumb/shapes/ground.hpp"

namespace plumb::detail {

/// This is ground other than a plane, prepared for contact: a rounded convex shape or a mesh.
class GroundShape {
 public:
  GroundShape(const Box& box, std::uint32_t number);
  explicit GroundShape(const GroundCapsule& capsule);
  explicit GroundShape(const GroundHull& hull);
  explicit GroundShape(const GroundMesh& mesh);
  explicit GroundShape(const HeightField& field);

  static constexpr std::uint32_t none = 0xffffffff;
  /// Returns its number among the boxes, or none.
  std::uint32_t box() const { return box_; }
  const Bounds& bounds() const { return bounds_; }
  const Surface& surface() const { return surface_; }
  const Filter& filter() const { return filter_; }
  /// Returns whether it may reach into a box. A solid reaches into all of its bounds.
  bool reaches_into(const Bounds& bounds) const;
  bool is_convex() const { return !mesh_; }
  /// Returns whether a place is in what it encloses as a landscape or as a solid mesh.
  bool encloses(Vec3 p) const;
  /// Returns the capsule that it is, if it is one.
  std::optional<Segment> capsule() const {
    if (line_.empty()) return std::nullopt;
    return Segment{line_.front(), line_.back(), radius_};
  }
  /// Returns whether a point may be within `reach` (m) of it.
  bool may_reach(Vec3 p, double reach) const {
    if (line_.empty()) return distance2(bounds_, p) <= reach * reach;
    const Vec3 a = line_.front(), b = line_.back();
    const Vec3 apart = p - between(a, b, place_along(a, b, p));
    return dot(apart, apart) <= (reach + radius_) * (reach + radius_);
  }
  /// Returns how far (m) a point is from what is convex; inside that is less than 0.
  double distance(Vec3 p) const {
    return nearness({.vertices = {&p, 1}, .normals = {}}, convex()).distance - radius_;
  }

  /// Calls found(normal) for the faces of what is convex whose planes are near a place, or for its normal
  /// there.
  template <class Found>
  void for_normals(Vec3 at, double near, Found&& found) const {
    const Convex shape = convex();
    if (shape.faces() == 0 || radius_ > 0)
      return found(nearness({.vertices = {&at, 1}, .normals = {}}, shape).normal);
    for (std::uint32_t i = 0; i < shape.faces(); ++i)
      if (std::abs(dot(shape.normals[i], at - shape.vertices[shape.parts->face(i)[0]])) <= near)
        found(shape.normals[i]);
  }

  /// Calls taken(distance, normal) for the faces of what is convex and not rounded, with how far (m) a place
  /// is above them, from the highest on. Ends with the first that is taken, or after a few.
  template <class Taken>
  void for_exits(Vec3 at, Taken&& taken) const {
    const Convex shape = convex();
    const auto height = [&](std::uint32_t face) {
      return dot(shape.normals[face], at - shape.vertices[shape.parts->face(face)[0]]);
    };
    const std::uint32_t end = shape.faces();
    std::uint32_t last = end;
    for (std::uint32_t tried = 0; tried < 4 && radius_ == 0; ++tried) {
      std::uint32_t next = end;
      for (std::uint32_t i = 0; i < end; ++i) {
        const bool is_left =
            last == end || height(i) < height(last) || (height(i) == height(last) && i > last);
        if (is_left && (next == end || height(i) > height(next))) next = i;
      }
      if (next == end || taken(height(next), shape.normals[next])) return;
      last = next;
    }
  }

  /// Lists where it is near a point of a shape, as far as `reach` (m). See touch_mesh().
  void touch_point(Vec3 p, Vec3 middle, double reach, LineTouches& out) const;
  /// Lists where it is near a segment, between its ends.
  void touch_between(Vec3 p, Vec3 q, double reach, LineTouches& out) const;
  /// Lists where a hull is kept off it, as a.
  ConvexContacts touch_hull(const Convex& hull, Vec3 middle, double reach) const;
  /// Finds the first touch of what moves straight on, unless it touches at the start.
  std::optional<FirstTouch> first_touch(const MovingSegment& moving, double close) const;
  std::optional<FirstHullTouch> first_touch(const MovingHull& moving, double close) const;

 private:
  GroundShape(const GroundMesh& mesh, MeshSides sides);
  Convex convex() const;

  Array<Vec3> line_;  ///< of a capsule
  ConvexHull hull_;
  double radius_ = 0;
  std::optional<TriangleMesh> mesh_;
  Bounds bounds_{};
  Surface surface_;
  Filter filter_;
  std::uint32_t box_ = none;
};

/// Returns the cube of half sizes 1 about the origin.
ConvexHull unit_cube();

/// All below a landscape is solid, as deep as this (m).
inline constexpr double depth_of_fields = 1e6;

/// Returns the triangles of a landscape, which face upward.
GroundMesh mesh_of(const HeightField& field);

}  // namespace plumb::detail
