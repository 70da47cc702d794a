#include "plumb/scene.hpp"

#include <algorithm>
#include <cmath>
#include <compare>
#include <limits>
#include <vector>

#include "plumb/error.hpp"
#include "scene/barycentric.hpp"
#include "scene/bends/bends.hpp"
#include "scene/bends/twists.hpp"
#include "scene/reels/reels.hpp"
#include "scene/refuse.hpp"
#include "scene/second_moments.hpp"
#include "scene/springs/springs.hpp"
#include "scene/tackles/tackles.hpp"
#include "scene/tackles/validate_law.hpp"
#include "scene/validate_bodies.hpp"

namespace plumb {
namespace {

using detail::refuse;

void validate_surroundings(const Scene& scene) {
  if (!is_finite(scene.gravity)) refuse("gravity is not finite: ", scene.gravity);
  if (!std::isfinite(scene.drag)) refuse("drag is not finite: ", scene.drag);
  if (scene.drag < 0) refuse("drag is negative (", scene.drag, " per second)");
  if (!std::isfinite(scene.joint_drag)) refuse("joint_drag is not finite: ", scene.joint_drag);
  if (scene.joint_drag < 0) refuse("joint_drag is negative (", scene.joint_drag, " per second)");
}

void validate_particle(const Particle& particle, std::size_t i) {
  if (!is_finite(particle.position)) {
    refuse("particle ", i, ": position is not finite: ", particle.position);
  }
  if (!is_finite(particle.velocity)) {
    refuse("particle ", i, ": velocity is not finite: ", particle.velocity);
  }
  if (particle.fixed) return;  // its mass is ignored, and infinity is a fair way to write it
  if (!std::isfinite(particle.mass)) refuse("particle ", i, ": mass is not finite: ", particle.mass);
  if (particle.mass < 0) refuse("particle ", i, ": mass is negative (", particle.mass, " kg)");
}

void validate_rod(const Scene& scene, std::size_t i) {
  const Rod& rod = scene.rods[i];
  for (const std::uint32_t end : {rod.a, rod.b}) {
    if (end < scene.particles.size()) continue;
    refuse("rod ", i, ": particle ", end, " does not exist (the scene has ", scene.particles.size(),
           " particles)");
  }
  if (rod.a == rod.b) refuse("rod ", i, ": both ends are particle ", rod.a);
  if (scene.particles[rod.a].fixed && scene.particles[rod.b].fixed) {
    refuse("rod ", i, ": both ends (particles ", rod.a, " and ", rod.b, ") are fixed");
  }
  if (!std::isfinite(rod.mass)) refuse("rod ", i, ": mass is not finite: ", rod.mass);
  if (rod.mass < 0) refuse("rod ", i, ": mass is negative (", rod.mass, " kg)");
  if (rod.length < 0) refuse("rod ", i, ": length is negative (", rod.length, " m)");
  if (!(rod.center >= 0 && rod.center <= 1))
    refuse("rod ", i, ": center of mass must be a fraction from 0 to 1 of the way along it, got ",
           rod.center);
  if (rod.inertia && !(*rod.inertia >= 0 && std::isfinite(*rod.inertia)))
    refuse("rod ", i, ": inertia must be finite and not negative, got ", *rod.inertia, " kg m^2");
  for (const double drag : {rod.linear_drag, rod.orthogonal_drag})
    if (!(drag >= 0 && std::isfinite(drag)))
      refuse("rod ", i, ": drag must be finite and not negative, got ", drag, " per second");
  if ((rod.linear_drag != 0 || rod.orthogonal_drag != 0) && rod.mass == 0)
    refuse("rod ", i, ": has drag of the air, but no mass of its own for it to act on");
  detail::validate_law(rod.law, "rod ", i);
  const double length = rod_length(scene, i);
  if (!std::isfinite(length)) refuse("rod ", i, ": length is not finite: ", length);
  if (length == 0) {
    refuse("rod ", i, ": length is zero, no length is given and its ends (particles ", rod.a, " and ", rod.b,
           ") are at the same place");
  }
}

void refuse_duplicate_rods(const std::vector<Rod>& rods) {
  struct Ends {
    std::uint64_t pair;
    std::size_t rod;
    auto operator<=>(const Ends&) const = default;
  };
  Array<Ends> sorted;
  sorted.reserve(rods.size());
  for (std::size_t i = 0; i < rods.size(); ++i) {
    const auto [low, high] = std::minmax(rods[i].a, rods[i].b);
    sorted.push_back({std::uint64_t{low} << 32 | high, i});
  }
  std::sort(sorted.begin(), sorted.end());
  const auto twice = std::adjacent_find(sorted.begin(), sorted.end(),
                                        [](const Ends& a, const Ends& b) { return a.pair == b.pair; });
  if (twice == sorted.end()) return;
  const Rod& rod = rods[twice[1].rod];
  refuse("rod ", twice[1].rod, ": joins the same particles (", rod.a, " and ", rod.b, ") as rod ",
         twice->rod);
}

void validate_lumped_masses(const Scene& scene) {
  const std::vector<double> masses = lumped_masses(scene);
  for (std::size_t i = 0; i < masses.size(); ++i) {
    if (scene.particles[i].fixed) continue;
    if (masses[i] == 0)
      refuse("particle ", i, ": has no mass, neither its own nor from a rod, and is not fixed");
    if (!std::isfinite(masses[i])) refuse("particle ", i, ": mass with its share of its rods is not finite");
  }
}

}  // namespace

void validate(const Scene& scene) {
  validate_surroundings(scene);
  for (std::size_t i = 0; i < scene.particles.size(); ++i) validate_particle(scene.particles[i], i);
  for (std::size_t i = 0; i < scene.rods.size(); ++i) validate_rod(scene, i);
  refuse_duplicate_rods(scene.rods);
  detail::validate_bends(scene);
  detail::validate_twists(scene);
  detail::validate_tackles(scene);
  detail::validate_reels(scene);
  detail::validate_bodies(scene);
  validate_lumped_masses(scene);
  detail::validate_joints(scene);
  detail::validate_springs(scene);
  detail::validate_shapes(scene);
}

bool has_more_than_rods(const Scene& scene) {
  const bool plain = scene.bends.empty() && scene.twists.empty() && scene.tackles.empty() &&
                     scene.reels.empty() && scene.bodies.empty() && scene.pins.empty() &&
                     scene.alignments.empty() && scene.angles.empty() && scene.springs.empty() &&
                     scene.torsions.empty() && scene.capsules.empty() && scene.hulls.empty() &&
                     scene.planes.empty() && scene.boxes.empty() && scene.ground_capsules.empty() &&
                     scene.ground_hulls.empty() && scene.meshes.empty() && scene.height_fields.empty() &&
                     scene.platforms.empty();
  const bool sleeps = std::any_of(scene.particles.begin(), scene.particles.end(),
                                  [](const Particle& particle) { return particle.asleep; });
  const bool drags = std::any_of(scene.rods.begin(), scene.rods.end(), [](const Rod& rod) {
    return rod.linear_drag != 0 || rod.orthogonal_drag != 0;
  });
  return !plain || scene.joint_drag != 0 || sleeps || drags;
}

double rod_length(const Scene& scene, std::size_t i) {
  const Rod& rod = scene.rods[i];
  if (rod.length != 0) return rod.length;
  return norm(scene.particles[rod.b].position - scene.particles[rod.a].position);
}

RodMass rod_mass(const Scene& scene, std::size_t i, MassModel model) {
  const Rod& rod = scene.rods[i];
  if (rod.mass == 0 && !rod.inertia) return {};  // a rod's length may take a root
  const double first = rod.mass * rod.center;    // the integral of s over the mass, s from 0 at a to 1 at b
  if (model == MassModel::lumped) return {.aa = rod.mass - first, .ab = 0, .bb = first};
  const double length = rod_length(scene, i);
  const double about_center = rod.inertia ? *rod.inertia / (length * length) : rod.mass / 12;
  const double second = first * rod.center + about_center;  // the integral of s^2 over the mass
  return {.aa = rod.mass - 2 * first + second, .ab = first - second, .bb = second};
}

std::array<std::array<double, 4>, 4> body_mass(const Scene& scene, std::size_t i) {
  const Body& body = scene.bodies[i];
  const detail::Barycentric barycentric(detail::positions_of(scene, body.particles));
  const std::array<double, 4> at_center = barycentric.weights(body.center);
  const detail::Sym3 second = detail::second_moments(body.inertia);
  std::array<std::array<double, 4>, 4> mass{};
  for (std::size_t j = 0; j < 4; ++j)
    for (std::size_t k = 0; k <= j; ++k) {
      const Vec3 b_j = barycentric.gradients()[j], b_k = barycentric.gradients()[k];
      mass[j][k] = mass[k][j] = body.mass * at_center[j] * at_center[k] + dot(b_j, second * b_k);
    }
  return mass;
}

std::vector<double> lumped_masses(const Scene& scene) {
  std::vector<double> masses;
  masses.reserve(scene.particles.size());
  for (const Particle& particle : scene.particles) {
    masses.push_back(particle.fixed ? std::numeric_limits<double>::infinity() : particle.mass);
  }
  for (const Rod& rod : scene.rods) {
    masses[rod.a] += rod.mass * (1 - rod.center);
    masses[rod.b] += rod.mass * rod.center;
  }
  for (const Body& body : scene.bodies)
    for (const std::uint32_t particle : body.particles) masses[particle] += body.mass / 4;
  return masses;
}

double bounding_diagonal(const Scene& scene) {
  if (scene.particles.empty()) return 0;
  Vec3 low = scene.particles.front().position;
  Vec3 high = low;
  for (const Particle& particle : scene.particles) {
    const Vec3 p = particle.position;
    low = {std::min(low.x, p.x), std::min(low.y, p.y), std::min(low.z, p.z)};
    high = {std::max(high.x, p.x), std::max(high.y, p.y), std::max(high.z, p.z)};
  }
  return norm(high - low);
}

}  // namespace plumb
