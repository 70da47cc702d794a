#pragma once

#include <cstdint>
#include <vector>

#include "plumb/layouts/islands.hpp"
#include "plumb/scene.hpp"

namespace plumb::detail {

/// Finds the islands of a scene with the graph `graph` of particles and rods. A bend or a twist joins its
/// particles into one island, also through a fixed one. Without them they are those of
/// layouts::find_islands().
layouts::Islands find_bent_islands(const Scene& scene, const layouts::Graph& graph);

/// Returns the bends of every island, or nothing if the scene has none.
std::vector<std::vector<std::uint32_t>> bends_by_island(const Scene& scene, const layouts::Islands& islands);
/// Returns the twists of every island, or nothing if the scene has none.
std::vector<std::vector<std::uint32_t>> twists_by_island(const Scene& scene, const layouts::Islands& islands);

}  // namespace plumb::detail
