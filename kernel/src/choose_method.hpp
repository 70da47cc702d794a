#pragma once

#include <cstdint>

#include "plumb/layouts/islands.hpp"
#include "plumb/scene.hpp"
#include "plumb/settings.hpp"

namespace plumb::detail {

/// What method automatic takes for an island: relax or direct.
///
/// Trees are solved directly, whatever their size: all their rods at once cost about as much as a few sweeps,
/// and no number of sweeps that costs the same comes near. So is everything whose rods carry mass, which
/// relaxation cannot represent. A net or truss of massless rods is solved directly as long as its
/// factorisation costs less than the sweeps that relaxation would need for the same accuracy.
Method choose_method(const Scene& scene, const layouts::LocalGraph& island,
                     std::span<const std::uint32_t> rods, const Settings& settings);

}  // namespace plumb::detail
