#pragma once

#include "plumb/scene.hpp"
#include "plumb/vec3.hpp"

namespace plumb {

/// Pulls a place of an island to a target, as a hand, a cursor or a tracked controller does: a spring of
/// length 0 and a damper between them. See World::grab().
///
/// The place gets stiffness (target - place) + damping d(target - place)/dt, in N. Both are implicit, so that
/// a step is stable for any stiffness, and what grabs is a weightless thing that nothing pushes back.
///
/// Where a substep of h resolves the swing, h² stiffness/mass + h damping/mass < 1, nothing else is damped:
/// gradient mid keeps energy and is of second order, and so is old. The less of it a substep resolves, the
/// more the place is held where the target is at the substep's end, as by backward Euler.
struct Grab {
  Point at{};            ///< The place, of particles of one island, one of which is movable at least.
  Vec3 target{};         ///< Where it is pulled, in m.
  double stiffness = 0;  ///< Stiffness, in N/m.
  double damping = 0;    ///< Damping, in N s/m.

  /// Returns a grab of a particle.
  static Grab particle(std::uint32_t number, Vec3 target, double stiffness, double damping = 0) {
    return {{{number}, {1}}, target, stiffness, damping};
  }
  /// Returns a grab of a rod, at a share of the way from its end `a` (0) to `b` (1).
  static Grab rod(const Rod& rod, double share, Vec3 target, double stiffness, double damping = 0) {
    return {{{rod.a, rod.b}, {1 - share, share}}, target, stiffness, damping};
  }
};

}  // namespace plumb
