#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "plumb/export.hpp"
#include "plumb/scene.hpp"
#include "plumb/vec3.hpp"

namespace plumb {

/// Holds the strain, (current length − rest length) / rest length, over all rods of a scene. Files and
/// reports call it stretch. That of a slack cable is 0, and so is that of a rod without stiffness and
/// damping, which stands for one that broke.
struct Stretch {
  double rms = 0;             ///< Root mean square, without a unit.
  double max = 0;             ///< Largest absolute value, without a unit.
  std::uint32_t max_rod = 0;  ///< The rod that has it, in the scene's order.
};
/// Measures the strain of a scene's rods at `positions` (m), one per particle. Throws InputError on another
/// number of positions.
PLUMB_API Stretch measure_stretch(const Scene& scene, std::span<const Vec3> positions);

/// Holds energies, in J. A consistent mass matrix and lumped masses keep different energies. Measure with the
/// model that moved the scene.
struct Energy {
  double kinetic = 0;    ///< Kinetic energy, in J.
  double potential = 0;  ///< Potential energy −Σ m g·x, in J.
  /// Energy of bends, and Σ k (l − length)²/2 of elastic rods, tackles and springs that are not slack, in J.
  /// Likewise of torsions and of drives of angles. A torsion's angle is taken within half a turn, as turns do
  /// not show.
  double elastic = 0;
  /// Returns their sum, in J.
  double total() const { return kinetic + potential + elastic; }
};
/// Measures energies at `positions` (m) and `velocities` (m/s), one each per particle. Throws InputError on
/// another number of them.
PLUMB_API Energy measure_energy(const Scene& scene, std::span<const Vec3> positions,
                                std::span<const Vec3> velocities, MassModel model = MassModel::lumped);

/// Returns the energy in J of twist `i` of a valid scene, when it is twisted by `angle` (rad,
/// World::twist()). measure_energy() leaves it out, because a chain's twist does not follow from positions.
/// Throws InputError on an unknown twist.
PLUMB_API double twist_energy(const Scene& scene, std::size_t i, double angle);

/// Returns total mass × |g| × diagonal of the first bounding box, in J. Energy drift is relative to it.
PLUMB_API double energy_range(const Scene& scene);

/// Holds the momentum of the movable particles.
struct Momentum {
  Vec3 linear;          ///< Linear momentum, in kg·m/s.
  Vec3 angular;         ///< Angular momentum about the origin, in kg·m²/s.
  Vec3 center_of_mass;  ///< Centre of mass, in m.
};
/// Measures momentum at `positions` (m) and `velocities` (m/s), one each per particle. Throws InputError on
/// another number of them.
PLUMB_API Momentum measure_momentum(const Scene& scene, std::span<const Vec3> positions,
                                    std::span<const Vec3> velocities, MassModel model = MassModel::lumped);

/// Holds one saved instant of a trajectory or of a truth, with arrays in the scene's particle order.
struct Frame {
  double t = 0;                  ///< Time, in s.
  std::vector<Vec3> positions;   ///< Positions, in m.
  std::vector<Vec3> velocities;  ///< Velocities, in m/s.
  /// Mean pulls of the rods over the step before, in N, in the scene's order; empty if they are not known.
  std::vector<double> tensions{};
};

/// Returns the root mean square distance over all particles between positions and truth, in m. Throws
/// InputError if the two differ in number.
PLUMB_API double rms_distance(std::span<const Vec3> positions, std::span<const Vec3> truth);

}  // namespace plumb
