#pragma once

#include <cstdint>
#include <memory>
#include <vector>

#include "contest/stepper.hpp"
#include "plumb/scene.hpp"
#include "plumb/settings.hpp"

namespace plumb::bench {

/// Makes what one would write first: an array of particles x y z w and a list of rods. Eq. 4.7 of the thesis,
/// with its square root and division, corrects positions in place, one rod after the other in `order`.
///
/// It has no vector code and one thread. Denormal numbers are flushed as in plumb.
std::unique_ptr<Stepper> make_baseline(const Scene& scene, Precision precision,
                                       const std::vector<std::uint32_t>& order);

/// Returns the rods in the scene's order.
std::vector<std::uint32_t> natural_order(const Scene& scene);
/// Returns the rods colour by colour, those of a colour in the scene's order.
std::vector<std::uint32_t> colored_order(const Scene& scene);

}  // namespace plumb::bench
