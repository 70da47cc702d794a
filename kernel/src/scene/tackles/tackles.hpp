#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "plumb/layouts/graph.hpp"
#include "plumb/layouts/islands.hpp"
#include "plumb/scene.hpp"

namespace plumb::detail {

/// Refuses tackles as validate() says, in a scene whose particles pass it.
void validate_tackles(const Scene& scene);

/// Returns the energy of all elastic tackles at `positions` (m), in J.
double tackle_energy(const Scene& scene, std::span<const Vec3> positions);

/// Adds edges that join what tackles run through, also through fixed particles.
void join_tackles(const Scene& scene, std::vector<layouts::Edge>& edges);

/// Returns the tackles of every island, or nothing if the scene has none.
std::vector<std::vector<std::uint32_t>> tackles_by_island(const Scene& scene,
                                                          const layouts::Islands& islands);

}  // namespace plumb::detail
