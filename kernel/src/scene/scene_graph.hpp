#pragma once

#include <cstdint>

#include "plumb/layouts/graph.hpp"
#include "plumb/layouts/memory.hpp"
#include "plumb/scene.hpp"

namespace plumb::detail {

/// Shows a scene's particles and rods as layouts see them.
struct SceneGraph {
  explicit SceneGraph(const Scene& scene) {
    edges.reserve(scene.rods.size());
    for (const Rod& rod : scene.rods) edges.push_back({rod.a, rod.b});
    movable.reserve(scene.particles.size());
    for (const Particle& particle : scene.particles) movable.push_back(!particle.fixed);
  }

  /// Returns a view that is valid while this object lives.
  layouts::Graph view() const { return {static_cast<std::uint32_t>(movable.size()), edges, movable}; }

  Array<layouts::Edge> edges;
  Array<std::uint8_t> movable;
};

}  // namespace plumb::detail
