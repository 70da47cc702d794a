#pragma once

#include <algorithm>
#include <cmath>
#include <cstdint>

#include "plumb/settings.hpp"
#include "plumb/vec3.hpp"

namespace plumb::detail {

/// Holds a grab as a solver has it: a spring and a damper from a particle to a target that moves.
struct HeldGrab {
  std::uint32_t number = 0;           ///< the world's
  double stiffness = 0, damping = 0;  ///< N/m, N s/m
  Vec3 target{};                      ///< m, where the next substep starts
  Vec3 velocity{};                    ///< m/s, of the target in this step
  Vec3 impulse{};                     ///< N s, on the particle in this step
  double work = 0;                    ///< J, on the particle in this step

  void begin_step() {
    impulse = {};
    work = 0;
  }
};
template <class Archive>
void visit_members(Archive& archive, HeldGrab& of) {
  auto& [number, stiffness, damping, target, velocity, impulse, work] = of;
  archive(number, stiffness, damping, target, velocity, impulse, work);
}

/// Says how a grab takes part in one substep.
///
/// The particle's displacement d, which would be `before` without any force, has
///
///   m (d - before) = kick (others + F),   F = force - stiff (d - before),
///
/// so that kick stiff is an inertia of the substep, which adds to m, and force acts beside others. With all
/// forces on the right a solver has its own equation of a heavier particle, whose weight is what it was.
///
/// A resolved grab pulls as the middle of the substep's ends (mid), or as the mean of where three ends of
/// two substeps are, with weights 1, 2, 1 (old; Newmark 1959, with beta 1/4): both keep the energy of a
/// swing at any step. The less is resolved, the more it pulls as the end alone does, which is what new has
/// always.
struct GrabSubstep {
  Vec3 force{};      ///< N
  double stiff = 0;  ///< N/m
  double held = 0;   ///< 0 if it is resolved, and 1 if the end alone counts
  Vec3 before{};     ///< m
  bool is_mid = false;

  /// Begins a substep of `h` (s) of a particle of `mass` (kg) at `x` (m).
  static GrabSubstep begin(const HeldGrab& grab, Gradient gradient, double mass, Vec3 x, Vec3 before,
                           double h) {
    const double swing = (h * h * grab.stiffness + std::abs(h) * grab.damping) / mass;
    const double held = gradient == Gradient::new_ ? 1 : swing > 1 ? 1 - 1 / swing : 0;
    const auto pull_at = [&](double share) {
      return grab.stiffness * (grab.target + (share * h) * grab.velocity - x) + grab.damping * grab.velocity;
    };
    if (gradient == Gradient::mid) {
      const double share = (1 + held) / 2, stiff = share * grab.stiffness + grab.damping / h;
      return {pull_at(share) - stiff * before, stiff, held, before, true};
    }
    const double ahead = (1 + 3 * held) / 4, damps = (1 + held) / 2;
    return {pull_at(held) - (held * grab.stiffness + grab.damping / h) * before,
            ahead * grab.stiffness + damps * grab.damping / h, held, before, false};
  }

  /// Takes note of the displacement `d` (m) that the substep came to, by forces that act by `kick` (s²).
  /// Velocities of mid change by `stop` times the particle's weight (kg m/s), see velocity_change().
  void end(double h, double kick, Vec3 d, Vec3 stop, HeldGrab& grab) const {
    const Vec3 pulled = ((is_mid ? 2 : 1) * kick / h) * (force - stiff * (d - before)) + stop;
    grab.impulse += pulled;
    grab.work += dot(pulled, (1 / h) * d);
    grab.target += h * grab.velocity;
  }
  /// Returns by how much the velocity of gradient mid is to be another, where `past_mean` (m/s) is what it
  /// has beyond the mean velocity of the substep. What is held does not swing about that.
  Vec3 velocity_change(Vec3 past_mean) const { return (is_mid ? -held : 0) * past_mean; }
};

}  // namespace plumb::detail
