#include "plumb/measures.hpp"

#include <cmath>
#include <string>

#include "plumb/error.hpp"

namespace plumb {
namespace {

void require_size(const char* what, std::size_t size, std::size_t expected) {
  if (size == expected) return;
  throw InputError(std::string(what) + ": expected " + std::to_string(expected) + " entries, got " +
                   std::to_string(size));
}

}  // namespace

Stretch measure_stretch(const Scene& scene, std::span<const Vec3> positions) {
  require_size("positions", positions.size(), scene.particles.size());
  Stretch result;
  double sum_of_squares = 0;
  for (std::size_t i = 0; i < scene.rods.size(); ++i) {
    const Rod& rod = scene.rods[i];
    const double length = rod_length(scene, i);
    const double stretch = (norm(positions[rod.b] - positions[rod.a]) - length) / length;
    sum_of_squares += stretch * stretch;
    // The first NaN stays: it compares false with everything, and a maximum that dropped it would hide a rod
    // gone bad.
    if (!(std::abs(stretch) <= result.max) && !std::isnan(result.max)) {
      result.max = std::abs(stretch);
      result.max_rod = static_cast<std::uint32_t>(i);
    }
  }
  if (!scene.rods.empty()) result.rms = std::sqrt(sum_of_squares / static_cast<double>(scene.rods.size()));
  return result;
}

Energy measure_energy(const Scene& scene, std::span<const Vec3> positions, std::span<const Vec3> velocities) {
  require_size("positions", positions.size(), scene.particles.size());
  require_size("velocities", velocities.size(), scene.particles.size());
  const std::vector<double> masses = lumped_masses(scene);
  Energy energy;
  for (std::size_t i = 0; i < masses.size(); ++i) {
    if (scene.particles[i].fixed) continue;
    energy.kinetic += 0.5 * masses[i] * dot(velocities[i], velocities[i]);
    energy.potential -= masses[i] * dot(scene.gravity, positions[i]);
  }
  return energy;
}

double energy_range(const Scene& scene) {
  double mass = 0;
  for (const Particle& particle : scene.particles) mass += particle.fixed ? 0 : particle.mass;
  for (const Rod& rod : scene.rods) mass += rod.mass;
  return mass * norm(scene.gravity) * bounding_diagonal(scene);
}

Momentum measure_momentum(const Scene& scene, std::span<const Vec3> positions,
                          std::span<const Vec3> velocities) {
  require_size("positions", positions.size(), scene.particles.size());
  require_size("velocities", velocities.size(), scene.particles.size());
  const std::vector<double> masses = lumped_masses(scene);
  Momentum result;
  Vec3 first_moment;
  double total_mass = 0;
  for (std::size_t i = 0; i < masses.size(); ++i) {
    if (scene.particles[i].fixed) continue;
    const Vec3 momentum = masses[i] * velocities[i];
    result.linear += momentum;
    result.angular += cross(positions[i], momentum);
    first_moment += masses[i] * positions[i];
    total_mass += masses[i];
  }
  if (total_mass > 0) result.center_of_mass = (1 / total_mass) * first_moment;
  return result;
}

double rms_distance(std::span<const Vec3> positions, std::span<const Vec3> truth) {
  require_size("positions", positions.size(), truth.size());
  if (positions.empty()) return 0;
  double sum_of_squares = 0;
  for (std::size_t i = 0; i < positions.size(); ++i) {
    const Vec3 difference = positions[i] - truth[i];
    sum_of_squares += dot(difference, difference);
  }
  return std::sqrt(sum_of_squares / static_cast<double>(positions.size()));
}

}  // namespace plumb
