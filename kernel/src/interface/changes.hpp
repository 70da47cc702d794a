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

/// Says how long a cord is (m), and how fast that changes (m/s).
struct CordLength {
  double length, rate;
};

/// Notes that a solver is told of a cord's length. Velocities of the last step are those of the rates then,
/// so that they are found before another rate. A length that is told at a step's end may differ by rounding.
/// Velocities are not known any more then, since nobody is to find others before than after.
///
/// Returns whether the rate changes by more than rounding.
template <class FindVelocities>
bool see_change(const CordLength& before, const CordLength& after, bool& velocities_known,
                FindVelocities&& find_velocities) {
  if (after.rate != before.rate)
    find_velocities();
  else if (after.length != before.length)
    velocities_known = false;
  return rate_changes(before.rate, after.rate);
}

}  // namespace plumb::detail
