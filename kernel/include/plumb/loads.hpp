#pragma once

#include <functional>
#include <span>

#include "plumb/export.hpp"
#include "plumb/scene.hpp"
#include "plumb/vec3.hpp"

namespace plumb {

/// Shows a load the middle of the step that it acts in, as the start of the step predicts it.
struct LoadState {
  double time;                       ///< Simulated time of the middle, in s.
  std::span<const Vec3> positions;   ///< Positions in m, in the scene's particle order.
  std::span<const Vec3> velocities;  ///< Velocities in m/s, in the same order.
};

/// Adds forces (N) that depend on time and state to `forces`, which has one entry per particle and is zero.
using Load = std::function<void(const LoadState& state, std::span<Vec3> forces)>;

/// Returns where a place is, in m. The particles of `point` must be among `positions` (m).
PLUMB_API Vec3 position_of(const Point& point, std::span<const Vec3> positions);

/// Adds a force (N) at a place of a body or a rod to `forces`. Its work is exact: particles get it in
/// proportion to their weights. The particles of `point` must be among `forces`.
PLUMB_API void add_force(const Point& point, Vec3 force, std::span<Vec3> forces);

/// Adds a torque (N m) on a body to `forces` (N): a couple of forces on its four particles, which add up to
/// zero. Its work is exact for every turn of the body. Particles must be among `positions` (m) and `forces`.
PLUMB_API void add_torque(const Body& body, Vec3 torque, std::span<const Vec3> positions,
                          std::span<Vec3> forces);

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
