#pragma once

#include <cstdint>
#include <memory>
#include <vector>

#include "contest/stepper.hpp"
#include "plumb/scene.hpp"
#include "plumb/settings.hpp"

namespace plumb::bench {

/// What one would write first: an array of particles x y z w, a list of rods, and eq. 4.7 of the thesis with
/// its square root and division, one rod after the other in `order`, positions corrected in place. No vector
/// code, one thread, denormal numbers flushed as in plumb.
std::unique_ptr<Stepper> make_baseline(const Scene& scene, Precision precision,
                                       const std::vector<std::uint32_t>& order);

/// Rods in the scene's order.
std::vector<std::uint32_t> natural_order(const Scene& scene);
/// Rods colour by colour, those of a colour in the scene's order.
std::vector<std::uint32_t> colored_order(const Scene& scene);

}  // namespace plumb::bench
