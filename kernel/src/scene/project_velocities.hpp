#pragma once

#include <span>

#include "plumb/layouts/memory.hpp"
#include "plumb/scene.hpp"

namespace plumb::detail {

/// Removes from `velocities` (m/s) what pulls on rods. The change is the smallest, weighted by mass, after
/// which no rod's length changes at first order, or all do at `wanted` (m/s) if that is given.
///
/// It solves J M^-1 J^T lambda = J v by a sparse Cholesky factorisation, in linear time on trees. Redundant
/// rods share their impulse. Returns the largest change of a velocity in m/s, or 0 if nothing pulled.
double project_velocities(const Scene& scene, std::span<const double> inverse_masses, Array<Vec3>& velocities,
                          std::span<const double> wanted = {});

}  // namespace plumb::detail
