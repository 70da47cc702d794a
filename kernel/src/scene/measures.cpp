#include "plumb/measures.hpp"

#include <cmath>
#include <string>

#include "plumb/error.hpp"
#include "scene/bends/bends.hpp"
#include "scene/bends/twists.hpp"
#include "scene/reels/reels.hpp"
#include "scene/springs/springs.hpp"
#include "scene/tackles/tackles.hpp"

namespace plumb {
namespace {

void require_size(const char* what, std::size_t size, std::size_t expected) {
  if (size == expected) return;
  throw InputError(std::string(what) + ": expected " + std::to_string(expected) + " entries, got " +
                   std::to_string(size));
}

/// Calls f(mass, a, b) for every entry (kg) of the mass matrix in which a movable particle has a part. For a
/// != b the two equal entries come as one sum. What a fixed particle carries alone does not move and is left
/// out.
template <class F>
void for_masses(const Scene& scene, MassModel model, F&& f) {
  const auto movable = [&](std::uint32_t i) { return !scene.particles[i].fixed; };
  for (std::uint32_t i = 0; i < scene.particles.size(); ++i)
    if (movable(i)) f(scene.particles[i].mass, i, i);
  for (std::uint32_t i = 0; i < scene.rods.size(); ++i) {
    const auto& rod = scene.rods[i];
    if (rod.mass == 0) continue;
    const RodMass m = rod_mass(scene, i, model);
    if (movable(rod.a)) f(m.aa, rod.a, rod.a);
    if (movable(rod.b)) f(m.bb, rod.b, rod.b);
    if (m.ab != 0) f(2 * m.ab, rod.a, rod.b);
  }
  for (std::size_t i = 0; i < scene.bodies.size(); ++i) {
    const auto m = body_mass(scene, i);
    const auto& ids = scene.bodies[i].particles;
    for (std::size_t j = 0; j < 4; ++j) {
      if (movable(ids[j])) f(m[j][j], ids[j], ids[j]);
      for (std::size_t k = 0; k < j; ++k)
        if (movable(ids[j]) || movable(ids[k])) f(2 * m[j][k], ids[j], ids[k]);
    }
  }
}

/// Returns by how much rod `i` is too long, in m. A cable is never too short, and what holds nothing is never
/// too long.
double excess_length(const Scene& scene, std::size_t i, std::span<const Vec3> positions) {
  const Rod& rod = scene.rods[i];
  if (rod.law.stiffness == 0 && rod.law.damping == 0) return 0;
  const double excess = norm(positions[rod.b] - positions[rod.a]) - rod_length(scene, i);
  return rod.law.one_sided && excess < 0 ? 0 : excess;
}

}  // namespace

Stretch measure_stretch(const Scene& scene, std::span<const Vec3> positions) {
  require_size("positions", positions.size(), scene.particles.size());
  Stretch result;
  double sum_of_squares = 0;
  const Array<std::uint8_t> at_drums = detail::rods_at_drums(scene, positions);
  for (std::size_t i = 0; i < scene.rods.size(); ++i) {
    if (!at_drums.empty() && at_drums[i] != 0) continue;
    const double length = rod_length(scene, i);
    const double strain = excess_length(scene, i, positions) / length;
    sum_of_squares += strain * strain;
    // The first NaN stays, because it compares false with everything. A maximum that dropped it would hide a
    // rod that has no finite strain.
    if (!(std::abs(strain) <= result.max) && !std::isnan(result.max)) {
      result.max = std::abs(strain);
      result.max_rod = static_cast<std::uint32_t>(i);
    }
  }
  if (!scene.rods.empty()) result.rms = std::sqrt(sum_of_squares / static_cast<double>(scene.rods.size()));
  return result;
}

Energy measure_energy(const Scene& scene, std::span<const Vec3> positions, std::span<const Vec3> velocities,
                      MassModel model) {
  require_size("positions", positions.size(), scene.particles.size());
  require_size("velocities", velocities.size(), scene.particles.size());
  Energy energy;
  for_masses(scene, model, [&](double mass, std::uint32_t a, std::uint32_t b) {
    energy.kinetic += 0.5 * mass * dot(velocities[a], velocities[b]);
    energy.potential -= 0.5 * mass * dot(scene.gravity, positions[a] + positions[b]);
  });
  for (std::size_t i = 0; i < scene.rods.size(); ++i) {
    const RodLaw& law = scene.rods[i].law;
    if (!law.is_elastic()) continue;
    const double excess = excess_length(scene, i, positions);
    energy.elastic += 0.5 * law.stiffness * excess * excess;
  }
  energy.elastic += detail::bending_energy(scene, positions) + detail::tackle_energy(scene, positions) +
                    detail::spring_energy(scene, positions);
  return energy;
}

double twist_energy(const Scene& scene, std::size_t i, double angle) {
  if (i >= scene.twists.size())
    throw InputError("twist " + std::to_string(i) + ": unknown, the scene has " +
                     std::to_string(scene.twists.size()) + " twists");
  const Twist& twist = scene.twists[i];
  return 0.5 * twist.stiffness / detail::twist_length(scene, detail::RodTable(scene), twist) * angle * angle;
}

double energy_range(const Scene& scene) {
  double mass = 0;
  for (const Particle& particle : scene.particles) mass += particle.fixed ? 0 : particle.mass;
  for (const Rod& rod : scene.rods) mass += rod.mass;
  for (const Body& body : scene.bodies) mass += body.mass;
  return mass * norm(scene.gravity) * bounding_diagonal(scene);
}

Momentum measure_momentum(const Scene& scene, std::span<const Vec3> positions,
                          std::span<const Vec3> velocities, MassModel model) {
  require_size("positions", positions.size(), scene.particles.size());
  require_size("velocities", velocities.size(), scene.particles.size());
  Momentum result;
  Vec3 first_moment;
  double total_mass = 0;
  for_masses(scene, model, [&](double mass, std::uint32_t a, std::uint32_t b) {
    const Vec3 momentum = (0.5 * mass) * velocities[b];
    const Vec3 other = (0.5 * mass) * velocities[a];
    result.linear += momentum + other;
    result.angular += cross(positions[a], momentum) + cross(positions[b], other);
    first_moment += (0.5 * mass) * (positions[a] + positions[b]);
    total_mass += mass;
  });
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
