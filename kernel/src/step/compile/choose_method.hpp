#pragma once

#include <cstdint>
#include <span>

#include "interface/island_shape.hpp"
#include "plumb/scene.hpp"
#include "plumb/settings.hpp"

namespace plumb::detail {

/// What method automatic takes for an island: direct if its shape is for that, if its rods carry mass, which
/// relaxation cannot represent, or if an accuracy is asked for, which relaxation cannot promise; relax for
/// the rest, wide nets of massless rods.
Method choose_method(const Scene& scene, bool shape_is_for_direct, std::span<const std::uint32_t> rods,
                     const Settings& settings);

/// The gradient with which it solves an island directly if none is set: mid, which keeps energy however long,
/// or where an accuracy is asked for old, but for loops of rods with mass. (Trees may then change to mid and
/// back, see make_direct_simulation.)
Gradient choose_gradient(const Scene& scene, bool is_tree, std::span<const std::uint32_t> rods,
                         const Settings& settings);

/// The time order of its direct solves of an island of so many rods with such a gradient: 4 where the
/// accuracy asked for is such that it pays.
std::uint32_t choose_time_order(Gradient gradient, bool is_tree, std::size_t rods, const Settings& settings);

}  // namespace plumb::detail
