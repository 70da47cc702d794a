#pragma once

#include <span>

#include "plumb/vec3.hpp"
#include "scene/refuse.hpp"

namespace plumb::detail {

/// What bounding volumes ask of the points they are made of; throws InputError with the number of the point.
inline void require_points(std::span<const Vec3> points) {
  if (points.empty()) refuse("a bounding volume needs a point at least");
  for (std::size_t i = 0; i < points.size(); ++i)
    if (!is_finite(points[i])) refuse("point ", i, ": position is not finite");
}

}  // namespace plumb::detail
