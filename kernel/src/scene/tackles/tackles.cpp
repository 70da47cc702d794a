#include "scene/tackles/tackles.hpp"

#include <algorithm>
#include <cmath>
#include <vector>

#include "scene/refuse.hpp"
#include "scene/tackles/validate_law.hpp"

namespace plumb::detail {
namespace {

void validate_particles(const Scene& scene, std::size_t i) {
  const std::vector<std::uint32_t>& particles = scene.tackles[i].particles;
  if (particles.size() < 2) refuse("tackle ", i, ": needs two particles at least, got ", particles.size());
  for (const std::uint32_t particle : particles) {
    if (particle < scene.particles.size()) continue;
    refuse("tackle ", i, ": particle ", particle, " does not exist (the scene has ", scene.particles.size(),
           " particles)");
  }
  const auto twice = std::adjacent_find(particles.begin(), particles.end());
  if (twice != particles.end()) refuse("tackle ", i, ": runs from particle ", *twice, " to itself");
  if (std::all_of(particles.begin(), particles.end(),
                  [&](std::uint32_t particle) { return scene.particles[particle].fixed; }))
    refuse("tackle ", i, ": all of its particles are fixed");
}

void validate_tackle(const Scene& scene, std::size_t i) {
  validate_particles(scene, i);
  const Tackle& tackle = scene.tackles[i];
  validate_law(tackle.law, "tackle ", i);
  if (std::isfinite(tackle.law.strength)) refuse("tackle ", i, ": has a strength, but cords do not break");
  const double length = tackle_length(scene, i);
  if (!(length > 0 && std::isfinite(length)))
    refuse("tackle ", i, ": length must be positive and finite, got ", length, " m");
  if (!(tackle.friction >= 0 && std::isfinite(tackle.friction)))
    refuse("tackle ", i, ": friction must be finite and not negative, got ", tackle.friction);
}

double way_through(const Tackle& tackle, std::span<const Vec3> positions) {
  double sum = 0;
  for (std::size_t k = 1; k < tackle.particles.size(); ++k)
    sum += norm(positions[tackle.particles[k]] - positions[tackle.particles[k - 1]]);
  return sum;
}

}  // namespace

void validate_tackles(const Scene& scene) {
  for (std::size_t i = 0; i < scene.tackles.size(); ++i) validate_tackle(scene, i);
}

double tackle_energy(const Scene& scene, std::span<const Vec3> positions) {
  double sum = 0;
  for (std::size_t i = 0; i < scene.tackles.size(); ++i) {
    const Tackle& tackle = scene.tackles[i];
    if (!tackle.law.is_elastic()) continue;
    const double excess = way_through(tackle, positions) - tackle_length(scene, i);
    if (tackle.law.one_sided && excess < 0) continue;
    sum += 0.5 * tackle.law.stiffness * excess * excess;
  }
  return sum;
}

}  // namespace plumb::detail

namespace plumb {

double tackle_length(const Scene& scene, std::size_t i) {
  const Tackle& tackle = scene.tackles[i];
  if (tackle.length != 0) return tackle.length;
  double sum = 0;
  for (std::size_t k = 1; k < tackle.particles.size(); ++k)
    sum += norm(scene.particles[tackle.particles[k]].position -
                scene.particles[tackle.particles[k - 1]].position);
  return sum;
}

}  // namespace plumb
