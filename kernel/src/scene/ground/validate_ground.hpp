#pragma once

#include <span>
#include <string>

#include "plumb/scene.hpp"

/// This file holds what validate() asks of ground beside planes and boxes, and of hulls. Every function
/// throws InputError.
namespace plumb::detail {

/// Refuses negative friction and restitution outside [0, 1]. `name` is for messages.
void validate_surface(const Surface& surface, const std::string& name);

void validate_hulls(const Scene& scene);
void validate_ground(const Scene& scene);

}  // namespace plumb::detail
