#pragma once

#include <span>

#include "contact/ground/ground_numbers.hpp"
#include "contact/ground/ground_shape.hpp"
#include "contact/linkage/linkage_state.hpp"
#include "contact/platforms/anchored.hpp"
#include "contact/platforms/platforms.hpp"
#include "contact/shapes/touch.hpp"
#include "plumb/layouts/memory.hpp"

namespace plumb::detail {

/// Holds the ground of a scene, its planes, boxes, other shapes and those on anchors, prepared for contact.
/// Ground on platforms is described as they are at home.
struct Surroundings {
  struct Solid {
    Vec3 center, half;
    Frame3 frame;
    Bounds bounds;
    Surface surface;
    Filter filter;
    GroundMotion motion;
  };
  /// Says where something may touch ground: a place on its line, or on a hull, is near a surface.
  struct Near {
    Vec3 place;       ///< m
    double distance;  ///< m, from the surface
    Vec3 normal;      ///< unit vector out of the surface
  };

  explicit Surroundings(const Scene& scene);

  bool are_empty() const {
    return planes.empty() && boxes.empty() && shapes.empty() && anchored.shapes().empty();
  }
  /// Returns whether some ground that shapes with such filters may touch reaches into the box `bounds` within
  /// the step.
  bool reach_into(const Bounds& bounds, std::span<const Filter> filters) const;
  /// Likewise of ground that moves, or whose surface does, within a step.
  bool move_under(const Bounds& bounds, std::span<const Filter> filters) const;
  /// Returns the speed (m/s) of the fastest surface of such ground, or 0.
  double speed_under(const Bounds& bounds, std::span<const Filter> filters) const;
  /// Returns the box `bounds` and what of its surroundings is reached when ground carries what is in it.
  Bounds carried(const Bounds& bounds, std::span<const Filter> filters) const;
  /// Returns whether some ground may move.
  bool may_move() const { return may_move_; }
  /// Returns whether some does in this step.
  bool any_moves() const { return moves_; }

  /// Returns the number of a shape among all ground.
  std::uint32_t number_of(std::uint32_t shape) const {
    if (const std::uint32_t box = shapes[shape].box(); box != GroundShape::none) return numbers.of_box(box);
    return numbers.of_other(shape - standing_boxes_);
  }
  /// Lists the shapes whose bounds overlap a box, ascending.
  void find(const Bounds& bounds, Array<std::uint32_t>& out) const;
  /// Returns whether what seems to touch a convex shape touches another one instead, which lies against it.
  /// So a floor of many solids is one. What is within `close` (m) of a shape lies against it. The bottom of
  /// what stands on a plane or a landscape is covered by that.
  bool is_covered(std::uint32_t shape, const Near& near, double close) const;
  /// Returns where a place that is in other ground than a shape, no deeper than what rests may be, comes out
  /// of it.
  Vec3 lifted(std::uint32_t shape, Vec3 place, double close) const;
  /// Returns whether what leaves a convex shape where it is near, and then all that it comes into by that, is
  /// out of ground within `reach` (m): in a corner between solids, and not in the middle of a floor of them.
  bool leads_out(std::uint32_t shape, const Near& near, double reach, double close) const;
  /// Returns whether the surface of convex shapes goes on flatly from a place on one of them, to both sides
  /// along a vector. A place between such sides needs not be touched.
  bool is_flat(std::uint32_t shape, Vec3 at, Vec3 along, double close) const;

  /// Begins a step of dt (s), and ends it. Anchors are set before.
  void begin_step(double dt);
  void end_step() { platforms.end_step(); }

  template <class Archive>
  friend void visit_members(Archive& archive, Surroundings& of);

  Array<Plane> planes;
  Array<Solid> boxes;
  Array<GroundShape> shapes;  ///< boxes without platforms, and all else that stands still
  BoundsTree tree;            ///< around their bounds
  ConvexHull cube;            ///< of half sizes 1, which boxes on platforms are made of; empty without any
  Platforms platforms;
  Anchored anchored;
  GroundNumbers numbers;

 private:
  /// Returns whether a place is within `near` (m) of a convex shape, but for one.
  bool is_within(std::uint32_t but, Vec3 place, double near) const;
  bool leads_down(Vec3 at, Vec3 normal, double close) const;
  bool goes_on(std::uint32_t shape, const GroundShape& other, Vec3 at, Vec3 normal, double close) const;
  /// Calls f(speed, belt, reaches) for all ground that shapes with such filters may touch, until f returns
  /// true. `speed` (m/s) is the fastest motion within `bounds`, and reaches(bounds) says whether it is there.
  template <class F>
  bool any_ground(const Bounds& bounds, std::span<const Filter> filters, F&& f) const;

  std::uint32_t standing_boxes_ = 0;  ///< the first of `shapes`
  bool may_move_ = false;
  bool moves_ = false;  ///< some ground does in this step
  double dt_ = 0;       ///< s, of this step
};

/// Returns the height (m) of a box's lowest point above a plane.
double height(const Bounds& bounds, const Plane& plane);
/// Returns the greatest speed (m/s) of ground within a box, but for its belts, in the next `dt` (s).
double fastest(const GroundRate& rate, const Bounds& bounds, double dt);
/// Returns a plane or a box where its platform has taken it.
Plane posed(const Plane& plane, const PlatformPose& pose);
Surroundings::Solid posed(const Surroundings::Solid& box, const PlatformPose& pose);
/// Returns the box around two places.
Bounds box_around(Vec3 p, Vec3 q);
/// Returns the box `bounds`, larger by `by` (m) on every side.
Bounds grown(const Bounds& bounds, double by);
/// Returns whether a shape with one of these filters may touch another.
bool may_touch(std::span<const Filter> filters, const Filter& other);

/// Lists how ground moves.
template <class Archive>
void visit_members(Archive& archive, Surroundings& of) {
  auto& [planes, boxes, shapes, tree, cube, platforms, anchored, numbers, standing_boxes, may_move, moves,
         dt] = of;
  archive(platforms, anchored, moves, dt);
}

}  // namespace plumb::detail
