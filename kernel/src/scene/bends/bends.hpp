#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "plumb/layouts/islands.hpp"
#include "plumb/scene.hpp"

namespace plumb::detail {

/// Refuses bends as validate() says, in a scene whose particles and rods pass it.
void validate_bends(const Scene& scene);

/// Returns the two lengths of every bend of a valid scene, in m: from a to b and from b to c. They are those
/// of rods, or the distance of two fixed particles without a rod.
std::vector<std::array<double, 2>> bend_lengths(const Scene& scene);

/// Returns the energy of all bends at `positions` (m), in J.
double bending_energy(const Scene& scene, std::span<const Vec3> positions);

/// Finds the islands of a scene with the graph `graph` of particles and rods. A bend or a tackle joins its
/// particles into one island, also through a fixed one. Without them they are those of
/// layouts::find_islands().
layouts::Islands find_bent_islands(const Scene& scene, const layouts::Graph& graph);

/// Returns for every island which entries of `movable` are movable particles of it, or nothing if there are
/// no entries.
std::vector<std::vector<std::uint32_t>> by_island(const Scene& scene, const layouts::Islands& islands,
                                                  std::span<const std::uint32_t> movable);

/// Returns the bends of every island, or nothing if the scene has none.
std::vector<std::vector<std::uint32_t>> bends_by_island(const Scene& scene, const layouts::Islands& islands);

}  // namespace plumb::detail
