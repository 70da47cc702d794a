#pragma once

#include <cstdint>
#include <span>

#include "plumb/layouts/islands.hpp"
#include "plumb/scene.hpp"
#include "plumb/settings.hpp"

namespace plumb::detail {

/// What method automatic takes for an island: relax or direct.
///
/// Trees are solved directly, whatever their size: all their rods at once cost about as much as a few sweeps,
/// and no number of sweeps that costs the same comes near. So is everything whose rods carry mass, which
/// relaxation cannot represent, and thin islands with loops (rings, ladders, trusses), where a correction
/// would have far to travel. Wide nets of massless rods are relaxed.
Method choose_method(const Scene& scene, const layouts::LocalGraph& island,
                     std::span<const std::uint32_t> rods, const Settings& settings);

/// The gradient that its direct solves take if none is set: old where an accuracy is asked for and no rod has
/// mass, since a step then costs a fraction of one of mid's; mid otherwise, which keeps energy however long.
Gradient choose_gradient(const Scene& scene, const Settings& settings);

}  // namespace plumb::detail
