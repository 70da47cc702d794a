#pragma once

#include <cstdint>
#include <span>

#include "interface/island_shape.hpp"
#include "plumb/scene.hpp"
#include "plumb/settings.hpp"

namespace plumb::detail {

/// Returns what method automatic takes for an island. Direct solves shapes that suit it, rods with mass,
/// which relaxation cannot represent, and islands with an accuracy, which relaxation cannot promise. Relax
/// takes the rest, wide nets of massless rods.
Method choose_method(const Scene& scene, bool shape_is_for_direct, std::span<const std::uint32_t> rods,
                     const Settings& settings);

/// Returns the gradient of an island's direct solve. It is the one that is set, or else mid, which keeps
/// energy at any step. With an accuracy it is old, but mid for loops of rods with mass. Trees may then change
/// to mid and back (see make_direct_simulation).
Gradient choose_gradient(const Scene& scene, bool is_tree, std::span<const std::uint32_t> rods,
                         const Settings& settings);

/// Returns the time order of an island's direct solve: 4 where all rods are rigid and the accuracy is fine
/// enough for that to pay, else 2.
std::uint32_t choose_time_order(const Scene& scene, Gradient gradient, bool is_tree,
                                std::span<const std::uint32_t> rods, const Settings& settings);

}  // namespace plumb::detail
