#pragma once

#include <span>

#include "plumb/vec3.hpp"
#include "scene/refuse.hpp"

namespace plumb::detail {

/// Refuses points that no bounding volume can be made of. Throws InputError with the number of the point.
inline void require_points(std::span<const Vec3> points) {
  if (points.empty()) refuse("a bounding volume needs a point at least");
  for (std::size_t i = 0; i < points.size(); ++i)
    if (!is_finite(points[i])) refuse("point ", i, ": position is not finite");
}

}  // namespace plumb::detail
