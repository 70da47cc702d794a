#pragma once

#include <vector>

#include "contact/linkage/linkage_state.hpp"
#include "contact/touch.hpp"

namespace plumb::detail {

/// The ground of a scene, planes and boxes, ready for use.
struct Surroundings {
  struct Solid {
    Vec3 center, half;
    Frame3 frame;
    Bounds bounds;
    Surface surface;
  };

  explicit Surroundings(const Scene& scene);

  bool are_empty() const { return planes.empty() && boxes.empty(); }
  /// Whether some ground reaches into the box.
  bool reach_into(const Bounds& bounds) const;

  std::vector<Plane> planes;
  std::vector<Solid> boxes;
};

/// The lowest height (m) of a box above a plane.
double height(const Bounds& bounds, const Plane& plane);

}  // namespace plumb::detail
