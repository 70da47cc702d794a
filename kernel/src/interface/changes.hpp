#pragma once

#include <algorithm>
#include <cmath>

#include "plumb/vec3.hpp"

namespace plumb::detail {

// Anchors, cords and drums that change their speed give a blow to velocities, and what that pulls is counted.
// Without it gradient mid would swing about the new speed for ever, an even number of substeps would keep the
// old one, and a cord with friction would rub by what swings.

/// Says whether an anchor's velocity (m/s) changes by more than the rounding of its path.
inline bool velocity_changes(Vec3 before, Vec3 after) {
  return !(norm(after - before) <= 1e-9 * norm(after));
}

/// Says whether the rate (m/s) of a cord's length or of a drum changes by more than rounding.
inline bool rate_changes(double before, double after) {
  return std::abs(after - before) > 1e-6 * std::max(std::abs(before), std::abs(after));
}

}  // namespace plumb::detail
