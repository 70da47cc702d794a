#pragma once

#include "plumb/export.hpp"
#include "plumb/scene.hpp"
#include "plumb/settings.hpp"

namespace plumb {

/// How stiff the springs of method springs are, linearised about a scene as it starts.
struct SpringStability {
  double frequency = 0;  ///< rad/s, of the fastest vibration without damping; 0 without springs
  /// s; the longest substep at which no vibration grows under the settings' integrator. 0 if there is none,
  /// infinity for the implicit ones and without springs. A vibration of frequency ω and damping ratio ζ
  /// allows
  ///   explicit_euler       2ζ/ω for ζ <= 1, so that an undamped spring grows at any step; where there is
  ///                        nothing but decay at a rate k, 2/k (thesis eq. 3.15)
  ///   semi_implicit_euler  2 (sqrt(1 + ζ²) - ζ)/ω: 2/ω without damping, as for Verlet
  ///   rk2, rk4             as far as |1 + z + z²/2 (+ z³/6 + z⁴/24)| <= 1 along z = λh; without damping 0
  ///                        and 2.83/ω
  /// Its ζ is not that of the settings: the end of a uniform rod is a quarter of its mass to a push across
  /// it, which doubles both ω and ζ.
  double largest_step = 0;
};

/// Predicts them from the stiffness, damping and mass matrices of the scene's springs. semi_implicit_euler's
/// limit and the frequency are exact at any size (to 1e-4 above 20,000 unknowns); the other explicit
/// integrators' limits up to 50 particles or 25 rods, above that from the fastest vibration alone. Slow
/// growth of swings and turns, which explicit Euler has at any step, is not a matter of the springs and is
/// left out. Throws what World throws.
PLUMB_API SpringStability spring_stability(const Scene& scene, const Settings& settings);

}  // namespace plumb
