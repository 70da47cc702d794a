#pragma once

#include <algorithm>
#include <cstdint>
#include <memory>
#include <vector>

#include "contact/linkage/linkage_state.hpp"
#include "contact/linkage/scene_parts.hpp"

/// Islands as the contact solver has them, each made from a scene.
namespace plumb::test {

/// The islands of a scene, awake.
struct Linkages {
  explicit Linkages(const Scene& scene) : parts(scene) {
    for (std::uint32_t i = 0; i < parts.count(); ++i) {
      const Scene& part = parts.part(i);
      const auto movable = static_cast<std::uint32_t>(std::count_if(
          part.particles.begin(), part.particles.end(), [](const Particle& each) { return !each.fixed; }));
      kinds.push_back(std::make_unique<detail::Linkage>(part, movable, Isa::scalar));
      detail::LinkageState& state = states.emplace_back();
      state.linkage = kinds.back().get();
      state.number = i;
      state.particles = parts.particles(i);
      state.force.resize(movable);
      state.acceleration.resize(movable);
      for (const Particle& particle : part.particles) {
        state.x.push_back(particle.position);
        state.v.push_back(particle.fixed ? Vec3{} : particle.velocity);
      }
    }
  }

  detail::SceneParts parts;
  std::vector<std::unique_ptr<detail::Linkage>> kinds;
  std::vector<detail::LinkageState> states;
};

}  // namespace plumb::test
