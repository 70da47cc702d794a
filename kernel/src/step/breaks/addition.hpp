#pragma once

#include <vector>

#include "contact/shapes/equal_capsules.hpp"
#include "plumb/report.hpp"
#include "plumb/scene.hpp"

namespace plumb::detail {

/// Holds what was added to a world at once, as the program described it, and which numbers it got.
struct Addition {
  std::vector<Particle> particles;
  std::vector<Rod> rods;
  std::vector<Bend> bends;
  std::vector<Tackle> tackles;
  std::vector<Capsule> capsules;
  Added first;

  Addition() = default;
  Addition(const Scene& scene, const Added& numbers)
      : particles(scene.particles),
        rods(scene.rods),
        bends(scene.bends),
        tackles(scene.tackles),
        capsules(scene.capsules),
        first(numbers) {}

  /// Returns it as a scene of its own.
  Scene scene(Vec3 gravity, double drag) const {
    return {.particles = particles,
            .rods = rods,
            .gravity = gravity,
            .drag = drag,
            .bends = bends,
            .tackles = tackles,
            .capsules = capsules};
  }

  friend bool operator==(const Addition&, const Addition&) = default;
};

template <class Archive>
void visit_members(Archive& archive, Addition& of) {
  auto& [particles, rods, bends, tackles, capsules, first] = of;
  archive(particles, rods, bends, tackles, capsules, first);
}

}  // namespace plumb::detail

namespace plumb {

// Archives find these beside the structs that they list.
template <class Archive>
void visit_members(Archive& archive, Particle& of) {
  auto& [position, velocity, mass, fixed, asleep] = of;
  archive(position, velocity, mass, fixed, asleep);
}
template <class Archive>
void visit_members(Archive& archive, RodLaw& of) {
  auto& [stiffness, damping, one_sided, strength] = of;
  archive(stiffness, damping, one_sided, strength);
}
template <class Archive>
void visit_members(Archive& archive, Rod& of) {
  auto& [a, b, length, mass, center, inertia, linear_drag, orthogonal_drag, law] = of;
  archive(a, b, length, mass, center, inertia, linear_drag, orthogonal_drag, law);
}
template <class Archive>
void visit_members(Archive& archive, Bend& of) {
  auto& [a, b, c, stiffness, angle, damping] = of;
  archive(a, b, c, stiffness, angle, damping);
}
template <class Archive>
void visit_members(Archive& archive, Tackle& of) {
  auto& [particles, length, law, friction] = of;
  archive(particles, length, law, friction);
}
template <class Archive>
void visit_members(Archive& archive, Added& of) {
  auto& [particle, rod, bend, tackle, capsule] = of;
  archive(particle, rod, bend, tackle, capsule);
}
template <class Archive>
void visit_members(Archive& archive, Point& of) {
  auto& [particles, weights] = of;
  archive(particles, weights);
}
template <class Archive>
void visit_members(Archive& archive, Surface& of) {
  auto& [friction, restitution, rolling, spinning] = of;
  archive(friction, restitution, rolling, spinning);
}
template <class Archive>
void visit_members(Archive& archive, Filter& of) {
  auto& [category, mask, group, own_island] = of;
  archive(category, mask, group, own_island);
}
template <class Archive>
void visit_members(Archive& archive, Capsule& of) {
  auto& [a, b, radius, surface, filter] = of;
  archive(a, b, radius, surface, filter);
}
}  // namespace plumb
