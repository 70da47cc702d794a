#pragma once

#include <cstddef>
#include <span>

#include "plumb/scene.hpp"

namespace plumb::detail {

/// Refuses springs and torsions that cannot be moved, as validate() says.
void validate_springs(const Scene& scene);

/// These refuse numbers of spring, torsion or angle `i` that make no sense. They do not read places.
void require_sound(const Spring& spring, std::size_t i);
void require_sound(const Torsion& torsion, std::size_t i);
void require_sound(const AngleControl& angle, std::size_t i);

/// Returns the energy of springs, torsions and drives of angles at `positions` (m), in J.
double spring_energy(const Scene& scene, std::span<const Vec3> positions);

}  // namespace plumb::detail
