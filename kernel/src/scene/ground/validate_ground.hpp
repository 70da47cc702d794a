#pragma once

#include <span>
#include <string>

#include "plumb/scene.hpp"
#include "scene/refuse.hpp"

/// This file holds what validate() asks of hulls, and of ground beside planes and boxes. Every function
/// throws InputError.
namespace plumb::detail {

/// Refuses what is not finite, negative friction, rolling or spinning, and restitution outside [0, 1]. `name`
/// is for messages.
void validate_surface(const Surface& surface, const std::string& name);
/// Does so for a shape other than a capsule, and refuses one that would touch its own island.
template <class Shape>
void validate_touch(const Shape& shape, const std::string& name) {
  validate_surface(shape.surface, name);
  if (shape.filter.own_island) refuse(name, ": own_island is for capsules alone");
}

/// Refuses hulls of bodies that do not exist, whose points lie in one plane, or with a negative radius.
void validate_hulls(const Scene& scene);
/// Refuses capsules and hulls of the ground likewise, meshes with triangles that have no area or do not fit
/// each other, and height fields without two rows of two.
void validate_ground(const Scene& scene);

}  // namespace plumb::detail
