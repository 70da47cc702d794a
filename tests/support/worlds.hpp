#pragma once

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <span>
#include <vector>

#include "plumb/plumb.hpp"
#include "plumb/reference/methods.hpp"

/// What tests ask of a world again and again.
namespace plumb::test {

/// Every test knows the thesis's other methods.
inline const bool knows_reference_methods = (register_reference_methods(), true);

inline std::vector<Vec3> positions_of(const World& world) {
  std::vector<Vec3> positions(world.particle_count());
  world.copy_positions(positions);
  return positions;
}

inline std::vector<Vec3> velocities_of(const World& world) {
  std::vector<Vec3> velocities(world.particle_count());
  world.copy_velocities(velocities);
  return velocities;
}

/// The farthest that two worlds' particles are apart, in m.
inline double apart(const World& one, const World& other) {
  double most = 0;
  for (std::uint32_t i = 0; i < one.particle_count(); ++i)
    if (one.handle<Particle>(i)) most = std::max(most, norm(one.position(i) - other.position(i)));
  return most;
}

/// `steps` steps of `dt` seconds; the sum of their reports.
inline StepReport run(World& world, double dt, int steps) {
  StepReport total;
  for (int i = 0; i < steps; ++i) total += world.step(dt);
  return total;
}

inline Stretch stretch_of(const Scene& scene, const World& world) {
  return measure_stretch(scene, positions_of(world));
}

inline Energy energy_of(const Scene& scene, const World& world) {
  return measure_energy(scene, positions_of(world), velocities_of(world));
}

/// Sum of kinetic and potential energy relative to the range that falling through the scene spans.
inline double relative_energy(const Scene& scene, const World& world) {
  return energy_of(scene, world).total() / energy_range(scene);
}

/// RMS distance to the truth, relative to the diagonal of the scene's first bounding box.
inline double relative_error(const Scene& scene, const World& world, const std::vector<Vec3>& truth) {
  return rms_distance(positions_of(world), truth) / bounding_diagonal(scene);
}

inline bool all_finite(const World& world) {
  const auto positions = positions_of(world), velocities = velocities_of(world);
  return std::all_of(positions.begin(), positions.end(), is_finite) &&
         std::all_of(velocities.begin(), velocities.end(), is_finite);
}

/// Largest rate at which a velocity field stretches a rod, in m/s: |d/|d| . (v_b - v_a)| at the scene's
/// positions.
inline double largest_stretching_rate(const Scene& scene, std::span<const Vec3> velocities) {
  double largest = 0;
  for (const Rod& rod : scene.rods) {
    const Vec3 d = scene.particles[rod.b].position - scene.particles[rod.a].position;
    largest = std::max(largest, std::abs(dot(d, velocities[rod.b] - velocities[rod.a])) / norm(d));
  }
  return largest;
}

inline Particle movable(Vec3 position, double mass = 1, Vec3 velocity = {}) {
  return {.position = position, .velocity = velocity, .mass = mass, .fixed = false};
}
inline Particle fixed(Vec3 position) {
  return {.position = position, .velocity = {}, .mass = 0, .fixed = true};
}

}  // namespace plumb::test
