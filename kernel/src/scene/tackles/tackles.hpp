#pragma once

#include <span>

#include "plumb/scene.hpp"

namespace plumb::detail {

/// Refuses tackles as validate() says, in a scene whose particles pass it.
void validate_tackles(const Scene& scene);

/// Returns the energy of all elastic tackles at `positions` (m), in J.
double tackle_energy(const Scene& scene, std::span<const Vec3> positions);

}  // namespace plumb::detail
