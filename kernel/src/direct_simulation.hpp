#pragma once

#include <memory>

#include "simulation.hpp"

namespace plumb::detail {

/// Method direct: trees by TreeStepper, islands with loops by LoopStepper.
std::unique_ptr<Simulation> make_direct_simulation(const Scene& scene, const Settings& settings);

}  // namespace plumb::detail
