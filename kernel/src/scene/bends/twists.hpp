#pragma once

#include <cstdint>

#include "plumb/layouts/memory.hpp"
#include "plumb/scene.hpp"
#include "scene/bends/rod_table.hpp"

namespace plumb::detail {

/// Refuses twists as validate() says, in a scene whose particles and rods pass it.
void validate_twists(const Scene& scene);

/// Returns the length of a twisted chain of a valid scene, in m. What clamps its ends does not count.
double twist_length(const Scene& scene, const RodTable& rods, const Twist& twist);

/// Says by rod whether it is twisted. It is empty if nothing is.
Array<std::uint8_t> twisted_rods(const Scene& scene);

}  // namespace plumb::detail
