#pragma once

#include "plumb/settings.hpp"
#include "plumb/vec3.hpp"

namespace plumb::detail {

/// Returns where a gradient points between a rod's old direction (0) and its new one (1).
constexpr double theta_of(Gradient gradient) {
  return gradient == Gradient::old ? 0 : gradient == Gradient::mid ? 0.5 : 1;
}

/// Returns (1 - e^-z)/z, the mean of e^-t over [0, z].
double mean_decay(double z);

/// Says how a particle moves where no rod pulls, from displacements of substeps (m) to velocities (m/s) and
/// back.
///
/// A displacement is the mean velocity of a substep times its length h (s), so it belongs to the substep's
/// middle. Gradient mid keeps the velocity at the substep's end times h instead. Drag is exact for constant
/// forces.
struct Verlet {
  Gradient gradient = Gradient::new_;
  double drag = 0;  ///< 1/s

  /// Holds the displacements (m) of the last substep and of the one before. Gradient mid has no use for the
  /// second.
  struct Displacements {
    Vec3 last;
    Vec3 before;
  };

  /// Returns what is left of the last displacement. A prediction is decay(h) times it plus kick(a, h), which
  /// force and gravity add. Gradient mid decays once in either half of the substep.
  ///
  /// Verlet's kick is a h^2 (thesis eq. 3.6, 4.5). Gradient mid, whose displacements are velocities times h,
  /// kicks by half of it.
  double decay(double h) const;
  Vec3 kick(Vec3 acceleration, double h) const;

  /// Returns the displacements before the first substep that make it the exact x + v h + a h^2/2, or its
  /// counterpart with drag.
  Displacements start(Vec3 velocity, Vec3 acceleration, double h) const;
  /// Returns the last displacement as if the substep had taken `next` instead of `h`. That keeps the velocity
  /// to second order.
  Vec3 change_step(Vec3 last, Vec3 acceleration, double h, double next) const;
  /// Keeps the present velocity when the acceleration changes. `change` is the difference times h^2, in m.
  Displacements change_acceleration(Displacements displacements, Vec3 change) const;
  /// Returns the velocity (m/s) at the end of the last substep, to second order.
  Vec3 velocity(const Displacements& displacements, double h) const {
    if (gradient == Gradient::mid) return (1 / h) * displacements.last;
    // The two displacements are mean velocities, half a substep and one and a half ago. A line through them
    // leads to the velocity of now.
    return (0.5 / h) * (3 * displacements.last - displacements.before);
  }
};

}  // namespace plumb::detail
