// This file puts particles elsewhere between two steps.

#include <algorithm>
#include <cmath>
#include <unordered_map>

#include "scene/refuse.hpp"
#include "step/step.hpp"

namespace plumb::detail {
namespace {

/// Rods may be off their lengths by this share of them, or by what they were before.
constexpr double fits = 1e-6;

double off(double distance, double length, const RodLaw& law) {
  return law.one_sided ? std::max(0.0, distance - length) : std::abs(distance - length);
}

}  // namespace

/// Refuses a move after which something rigid fits worse than before. at(particle) says where one will be.
template <class At>
void Step::require_fit(std::span<const std::uint32_t> particles, At&& at) const {
  const Scene& scene = breaks_.scene_now();
  for (const std::uint32_t particle : particles) {
    if (const auto reel = breaks_.reel_at(particle))
      refuse("particle ", particle, ": reel ", *reel, " is of its island, which keeps its place");
    for (const auto& [number, rod] : edits_.joined)
      if ((rod.a == particle || rod.b == particle) && !rod.law.is_elastic() &&
          !(off(norm(at(rod.b) - at(rod.a)), rod.length, rod.law) <= fits * rod.length))
        refuse("rod ", number, ": is joined in the next step, ", rod.length,
               " m long, and its ends would be ", norm(at(rod.b) - at(rod.a)), " m apart");
    for (const std::uint32_t rod : breaks_.rods_at(particle)) {
      const auto& [a, b, law] = std::tie(scene.rods[rod].a, scene.rods[rod].b, scene.rods[rod].law);
      if (law.is_elastic() || is_broken(rod) || (anchors_.is_fixed(a) && anchors_.is_fixed(b))) continue;
      const double length = lengths_.length(rod), distance = norm(at(b) - at(a));
      const double before = off(norm(position(b) - position(a)), length, law);
      if (!(off(distance, length, law) <= fits * length + before))
        refuse("rod ", rod, ": is ", length, " m long, and its ends would be ", distance, " m apart");
    }
  }
}

void Step::teleport(std::span<const std::uint32_t> particles, std::span<const Vec3> positions,
                    std::span<const Vec3> velocities) {
  breaks_.begin();
  std::unordered_map<std::uint32_t, std::size_t> number;
  for (std::size_t k = 0; k < particles.size(); ++k)
    if (!number.emplace(particles[k], k).second) refuse("particle ", particles[k], ": is listed twice");
  require_fit(particles, [&](std::uint32_t particle) {
    const auto found = number.find(particle);
    return found == number.end() ? position(particle) : positions[found->second];
  });
  // All particles of an island get their motion at once, so that those that stay are read before.
  struct Motion {
    std::uint32_t particle;
    Vec3 position, velocity;
  };
  std::vector<Motion> motions;
  const auto add = [&](std::uint32_t particle) {
    const auto found = number.find(particle);
    if (found == number.end())
      motions.push_back({particle, position(particle), velocity(particle)});
    else
      motions.push_back({particle, positions[found->second], velocities[found->second]});
  };
  std::unordered_map<std::uint32_t, bool> seen;
  for (const std::uint32_t particle : particles)
    for (const std::uint32_t each : breaks_.island_at(particle))
      if (!anchors_.is_fixed(each) && seen.emplace(each, true).second) add(each);
  for (std::size_t k = 0; k < particles.size(); ++k) {
    if (!anchors_.is_fixed(particles[k])) continue;
    anchors_.put(particles[k], positions[k]);
    for (const Place& place : compiled_.places.of(particles[k]))
      solver(place).place_anchor(place.slot, positions[k]);
  }
  std::vector<double> substeps;
  for (const Motion& motion : motions) {
    put_force(motion.particle, loads_.force(motion.particle));  // which wakes it
    const Place& home = compiled_.places.of(motion.particle).front();
    substeps.push_back(solver(home).last_substep(home.slot));
  }
  for (const auto& [particle, position, velocity] : motions)
    for (const Place& place : compiled_.places.of(particle))
      solver(place).set_motion(place.slot, position, velocity);
  for (std::size_t k = 0; k < motions.size(); ++k)
    if (substeps[k] > 0)
      for (const Place& place : compiled_.places.of(motions[k].particle))
        solver(place).go_on(place.slot, substeps[k]);
}

}  // namespace plumb::detail
