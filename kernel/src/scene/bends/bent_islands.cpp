#include "scene/bends/bent_islands.hpp"

#include <algorithm>
#include <span>

#include "scene/bends/bends.hpp"

namespace plumb::detail {
namespace {

/// Returns the first of `particles` that is movable. There is one.
std::uint32_t first_movable(const Scene& scene, std::span<const std::uint32_t> particles) {
  return *std::find_if(particles.begin(), particles.end(),
                       [&](std::uint32_t particle) { return !scene.particles[particle].fixed; });
}

/// Joins particles in a graph by edges to one of them that is movable.
void join(const Scene& scene, std::span<const std::uint32_t> particles, Array<layouts::Edge>& edges) {
  const std::uint32_t hub = first_movable(scene, particles);
  for (const std::uint32_t particle : particles)
    if (particle != hub) edges.push_back({hub, particle});
}

/// Sorts what joins particles by islands. `particles_of` returns those of one.
template <class List, class ParticlesOf>
Array<Array<std::uint32_t>> by_island(const Scene& scene, const layouts::Islands& islands, const List& list,
                                      ParticlesOf&& particles_of) {
  if (list.empty()) return {};
  Array<std::uint32_t> island_of(scene.particles.size(), 0);
  for (std::uint32_t i = 0; i < islands.count(); ++i)
    for (const std::uint32_t particle : islands.vertices(i))
      if (!scene.particles[particle].fixed) island_of[particle] = i;
  Array<Array<std::uint32_t>> out(islands.count());
  for (std::uint32_t i = 0; i < list.size(); ++i)
    out[island_of[first_movable(scene, particles_of(list[i]))]].push_back(i);
  return out;
}

/// Returns the particles of a tackle, a twist or a reel.
constexpr auto particles_of_chain = [](const auto& element) -> const auto& {
  return element.particles;
};

}  // namespace

layouts::Islands find_bent_islands(const Scene& scene, const layouts::Graph& graph) {
  if (scene.bends.empty() && scene.tackles.empty() && scene.twists.empty())
    return layouts::find_islands(graph);
  Array<layouts::Edge> edges(graph.edges.begin(), graph.edges.end());
  const auto rods = static_cast<std::uint32_t>(edges.size());
  for (const Bend& bend : scene.bends) join(scene, particles_of(bend), edges);
  for (const Tackle& tackle : scene.tackles) join(scene, tackle.particles, edges);
  for (const Twist& twist : scene.twists) join(scene, twist.particles, edges);
  layouts::Islands islands = layouts::find_islands({graph.vertices, edges, graph.movable});
  // Only rods stay. An island's edges ascend, so that its own come first.
  Array<std::uint32_t> begin{0}, list;
  for (std::uint32_t i = 0; i < islands.count(); ++i) {
    for (const std::uint32_t edge : islands.edges(i))
      if (edge < rods) list.push_back(edge);
    begin.push_back(static_cast<std::uint32_t>(list.size()));
  }
  islands.edge_begin = std::move(begin);
  islands.edge_list = std::move(list);
  return islands;
}

IslandElements::IslandElements(const Scene& scene, const layouts::Islands& islands)
    : bends_(by_island(scene, islands, scene.bends, [](const Bend& bend) { return particles_of(bend); })),
      tackles_(by_island(scene, islands, scene.tackles, particles_of_chain)),
      twists_(by_island(scene, islands, scene.twists, particles_of_chain)),
      reels_(by_island(scene, islands, scene.reels, particles_of_chain)) {}

}  // namespace plumb::detail
