#pragma once

#include <cstdint>
#include <span>

#include "plumb/layouts/graph.hpp"
#include "plumb/scene.hpp"

namespace plumb::detail {

/// Returns whether an island with loops is always solved directly: a ring, ladder or truss, in which a
/// correction would have far to travel. Trees of any size are solved directly too. All their rods at once
/// cost about as much as a few sweeps, and no sweeps of that cost come near the solution.
bool is_thin(const layouts::Graph& island);

/// Returns whether some rods are not rigid.
bool has_laws(const Scene& scene, std::span<const std::uint32_t> rods);

/// Returns whether rods carry masses that couple their ends.
bool carries_mass(const Scene& scene, std::span<const std::uint32_t> rods, MassModel model);

}  // namespace plumb::detail
