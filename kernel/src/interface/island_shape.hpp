#pragma once

#include <cstdint>
#include <span>

#include "plumb/layouts/graph.hpp"
#include "plumb/scene.hpp"

namespace plumb::detail {

/// Whether an island with loops is one that is always solved directly: a ring, ladder or truss, where a
/// correction would have far to travel. So are trees, whatever their size: all their rods at once cost about
/// as much as a few sweeps, and no number of sweeps that costs the same comes near.
bool is_thin(const layouts::Graph& island);

/// Whether rods carry masses that couple their ends.
bool carries_mass(const Scene& scene, std::span<const std::uint32_t> rods, MassModel model);

}  // namespace plumb::detail
