#pragma once

#include "plumb/export.hpp"
#include "plumb/scene.hpp"
#include "plumb/settings.hpp"

namespace plumb {

/// Says how stiff the springs of method springs are, linearised about a scene as it starts.
struct SpringStability {
  double frequency = 0;  ///< Frequency of the fastest vibration without damping, in rad/s; 0 without springs.
  /// No vibration grows under the settings' integrator at substeps up to this, in s.
  ///
  /// It is 0 if there is none, and infinite for implicit integrators and without springs. A vibration of
  /// frequency ω and damping ratio ζ allows:
  ///
  /// - explicit_euler: 2ζ/ω for ζ <= 1, so that an undamped spring grows at any step. Where there is nothing
  ///   but decay at a rate k, it allows 2/k (thesis eq. 3.15).
  /// - semi_implicit_euler: 2 (sqrt(1 + ζ²) - ζ)/ω, which is 2/ω without damping, as for Verlet.
  /// - rk2, rk4: as far as |1 + z + z²/2 (+ z³/6 + z⁴/24)| <= 1 along z = λh. Without damping that is 0 and
  ///   2.83/ω.
  ///
  /// This ζ is not that of the settings. To a push across it, the end of a uniform rod weighs a quarter of
  /// the rod, which doubles both ω and ζ.
  double largest_step = 0;
};

/// Predicts stability from the stiffness, damping and mass matrices of the scene's springs.
///
/// The frequency and semi_implicit_euler's limit are exact at any size, to 1e-4 above 20,000 unknowns. Limits
/// of the other explicit integrators are exact up to 50 particles or 25 rods. Above that they come from the
/// fastest vibration alone. Swings and turns grow slowly under explicit Euler at any step. That is not a
/// matter of the springs and is left out. Throws what World throws.
PLUMB_API SpringStability spring_stability(const Scene& scene, const Settings& settings);

}  // namespace plumb
