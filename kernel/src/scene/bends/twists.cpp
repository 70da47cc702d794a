#include "scene/bends/twists.hpp"

#include <algorithm>
#include <cmath>

#include "scene/refuse.hpp"

namespace plumb::detail {
namespace {

void validate_twisting(const Twist& twist, std::size_t i) {
  if (!(twist.stiffness > 0 && std::isfinite(twist.stiffness)))
    refuse("twist ", i, ": stiffness must be positive and finite, got ", twist.stiffness, " N m^2");
  if (!std::isfinite(twist.angle)) refuse("twist ", i, ": angle is not finite: ", twist.angle);
}

void validate_chain(const Scene& scene, std::size_t i) {
  const auto& particles = scene.twists[i].particles;
  if (particles.size() < 3)
    refuse("twist ", i, ": needs a chain of three particles or more, got ", particles.size());
  for (const std::uint32_t particle : particles)
    if (particle >= scene.particles.size())
      refuse("twist ", i, ": particle ", particle, " does not exist (the scene has ", scene.particles.size(),
             " particles)");
  const bool is_ring = particles.front() == particles.back();
  if (is_ring && particles.size() == 3) refuse("twist ", i, ": a ring needs three different particles");
  Array<std::uint32_t> sorted(particles.begin() + (is_ring ? 1 : 0), particles.end());
  std::sort(sorted.begin(), sorted.end());
  const auto twice = std::adjacent_find(sorted.begin(), sorted.end());
  if (twice != sorted.end()) refuse("twist ", i, ": goes through particle ", *twice, " twice");
  if (std::all_of(sorted.begin(), sorted.end(), [&](std::uint32_t p) { return scene.particles[p].fixed; }))
    refuse("twist ", i, ": all of its particles are fixed");
}

}  // namespace

void validate_twists(const Scene& scene) {
  if (scene.twists.empty()) return;
  const RodTable rods(scene);
  for (std::size_t i = 0; i < scene.twists.size(); ++i) {
    validate_chain(scene, i);
    validate_twisting(scene.twists[i], i);
    const auto& particles = scene.twists[i].particles;
    for (std::size_t k = 1; k < particles.size(); ++k)
      require_rod(scene, rods, {"twist ", i}, particles[k - 1], particles[k]);
  }
}

double twist_length(const Scene& scene, const RodTable& rods, const Twist& twist) {
  double length = 0;
  for (std::size_t k = 1; k < twist.particles.size(); ++k)
    if (const auto rod = rods.find(twist.particles[k - 1], twist.particles[k]))
      length += rod_length(scene, *rod);
  return length;
}

Array<std::uint8_t> twisted_rods(const Scene& scene) {
  if (scene.twists.empty()) return {};
  const RodTable rods(scene);
  Array<std::uint8_t> out(scene.rods.size(), 0);
  for (const Twist& twist : scene.twists) mark_rods(rods, twist.particles, out);
  return out;
}

}  // namespace plumb::detail
