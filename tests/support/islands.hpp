#pragma once

#include <cstdint>
#include <vector>

#include "interface/island_sets.hpp"
#include "plumb/layouts/islands.hpp"
#include "plumb/layouts/trees.hpp"
#include "scene/scene_graph.hpp"
#include "scenes/generators/generators.hpp"

/// The islands of a scene, as solvers are made of them.
namespace plumb::test {

/// A net that hangs from its first corner alone: a row that is straight between two anchors would have no
/// finite tension at first.
inline Scene hanging_net(std::uint32_t width, std::uint32_t height) {
  Scene scene = scenes::make_net(width, height);
  bool is_first = true;
  for (Particle& particle : scene.particles) {
    if (particle.fixed && !is_first) particle = {.position = particle.position, .mass = 1};
    is_first = is_first && !particle.fixed;
  }
  return scene;
}

struct IslandsOf {
  explicit IslandsOf(const Scene& scene)
      : edges(scene),
        islands(layouts::find_islands(edges.view())),
        sets{edges.view(), islands, layouts::group_equal_islands(edges.view(), islands)} {}

  layouts::LocalGraph local(std::uint32_t island) const {
    return layouts::local_graph(edges.view(), islands, island);
  }
  layouts::Tree tree(std::uint32_t island) const { return *layouts::find_tree(local(island).view()); }

  detail::SceneGraph edges;
  layouts::Islands islands;
  detail::IslandSets sets;
};

}  // namespace plumb::test
