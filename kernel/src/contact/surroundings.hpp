#pragma once

#include <vector>

#include "contact/linkage/linkage_state.hpp"
#include "contact/touch.hpp"

namespace plumb::detail {

/// Holds the ground of a scene, its planes and boxes, prepared for contact.
struct Surroundings {
  struct Solid {
    Vec3 center, half;
    Frame3 frame;
    Bounds bounds;
    Surface surface;
  };

  explicit Surroundings(const Scene& scene);

  bool are_empty() const { return planes.empty() && boxes.empty(); }
  /// Returns whether some ground reaches into the box `bounds`.
  bool reach_into(const Bounds& bounds) const;

  std::vector<Plane> planes;
  std::vector<Solid> boxes;
};

/// Returns the height (m) of a box's lowest point above a plane.
double height(const Bounds& bounds, const Plane& plane);

}  // namespace plumb::detail
