#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "plumb/export.hpp"
#include "plumb/scene.hpp"
#include "plumb/vec3.hpp"

namespace plumb {

/// Relative stretch, (current length − rest length) / rest length, over all rods of a scene.
struct Stretch {
  double rms = 0;
  double max = 0;             ///< largest absolute value
  std::uint32_t max_rod = 0;  ///< the rod that has it, in the scene's order
};
PLUMB_API Stretch measure_stretch(const Scene& scene, std::span<const Vec3> positions);

/// Energies in J; the potential is −Σ m g·x. What is exact for a consistent mass matrix differs from what
/// lumped masses keep.
struct Energy {
  double kinetic = 0;
  double potential = 0;
  double total() const { return kinetic + potential; }
};
PLUMB_API Energy measure_energy(const Scene& scene, std::span<const Vec3> positions,
                                std::span<const Vec3> velocities, MassModel model = MassModel::lumped);

/// Total mass × |g| × diagonal of the first bounding box, in J: what energy drift is relative to.
PLUMB_API double energy_range(const Scene& scene);

/// Of the movable particles: linear momentum in kg·m/s, angular momentum about the origin in kg·m²/s,
/// centre of mass in m.
struct Momentum {
  Vec3 linear;
  Vec3 angular;
  Vec3 center_of_mass;
};
PLUMB_API Momentum measure_momentum(const Scene& scene, std::span<const Vec3> positions,
                                    std::span<const Vec3> velocities, MassModel model = MassModel::lumped);

/// One saved instant of a trajectory or of a truth; arrays in the scene's particle order.
struct Frame {
  double t = 0;  ///< s
  std::vector<Vec3> positions;
  std::vector<Vec3> velocities;
};

/// RMS distance over all particles between positions and truth, in metres.
PLUMB_API double rms_distance(std::span<const Vec3> positions, std::span<const Vec3> truth);

}  // namespace plumb
