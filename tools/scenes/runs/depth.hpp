#pragma once

#include <span>

#include "plumb/scene.hpp"

namespace plumb::scenes {

/// Turns a direction of space into the axes of a box.
Vec3 to_axes(const Box& box, Vec3 v);

/// Returns how deep ends of capsules and corners of hulls are in planes, boxes and capsules of the ground, in
/// m, or 0 if none is.
double depth_in_ground(const Scene& scene, std::span<const Vec3> positions);

}  // namespace plumb::scenes
