#pragma once

#include <algorithm>
#include <tuple>
#include <vector>

#include "plumb/report.hpp"
#include "plumb/scene.hpp"

namespace plumb::detail {

/// Holds what was added to a world at once, as the program described it, and which numbers it got.
struct Addition {
  std::vector<Particle> particles;
  std::vector<Rod> rods;
  std::vector<Bend> bends;
  std::vector<Tackle> tackles;
  Added first;

  Addition() = default;
  Addition(const Scene& scene, const Added& numbers)
      : particles(scene.particles),
        rods(scene.rods),
        bends(scene.bends),
        tackles(scene.tackles),
        first(numbers) {}

  /// Returns it as a scene of its own.
  Scene scene(Vec3 gravity, double drag) const {
    return {.particles = particles,
            .rods = rods,
            .gravity = gravity,
            .drag = drag,
            .bends = bends,
            .tackles = tackles};
  }

  friend bool operator==(const Addition& one, const Addition& other) {
    const auto are_equal = [](const auto& a, const auto& b, auto&& members) {
      return std::equal(a.begin(), a.end(), b.begin(), b.end(),
                        [&](const auto& x, const auto& y) { return members(x) == members(y); });
    };
    return one.first == other.first &&
           are_equal(one.particles, other.particles,
                     [](const Particle& of) {
                       const auto& [a, b, c, d, e] = of;
                       return std::tie(a, b, c, d, e);
                     }) &&
           are_equal(one.rods, other.rods,
                     [](const Rod& of) {
                       const auto& [a, b, c, d, e, f, g, h, i] = of;
                       return std::tie(a, b, c, d, e, f, g, h, i);
                     }) &&
           are_equal(one.bends, other.bends,
                     [](const Bend& of) {
                       const auto& [a, b, c, d, e, f] = of;
                       return std::tie(a, b, c, d, e, f);
                     }) &&
           are_equal(one.tackles, other.tackles, [](const Tackle& of) {
             const auto& [a, b, c, d] = of;
             return std::tie(a, b, c, d);
           });
  }
};

template <class Archive>
void visit_members(Archive& archive, Addition& of) {
  auto& [particles, rods, bends, tackles, first] = of;
  archive(particles, rods, bends, tackles, first);
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
  auto& [particle, rod, bend, tackle] = of;
  archive(particle, rod, bend, tackle);
}
}  // namespace plumb
