#pragma once

#include <array>
#include <cstdint>
#include <span>

#include "plumb/layouts/memory.hpp"
#include "plumb/scene.hpp"

namespace plumb::detail {

/// Returns the particles of a bend, in their order.
inline std::array<std::uint32_t, 3> particles_of(const Bend& bend) {
  return {bend.a, bend.b, bend.c};
}

/// Refuses bends as validate() says, in a scene whose particles and rods pass it.
void validate_bends(const Scene& scene);

/// Returns the two lengths of every bend of a valid scene, in m: from a to b and from b to c. They are those
/// of rods, or the distance of two fixed particles without a rod.
Array<std::array<double, 2>> bend_lengths(const Scene& scene);

/// Returns the energy of all bends at `positions` (m), in J.
double bending_energy(const Scene& scene, std::span<const Vec3> positions);

}  // namespace plumb::detail
