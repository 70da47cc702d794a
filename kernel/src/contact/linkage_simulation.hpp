#pragma once

#include <memory>

#include "step/simulation.hpp"

namespace plumb::detail {

/// For scenes with more than particles and rods (is_articulated()): limbs, joints, contact and sleep, solved
/// directly in double. Throws InputError if the settings ask for what it does not do.
std::unique_ptr<Simulation> make_linkage_simulation(const Scene& scene, const Settings& settings);

}  // namespace plumb::detail
