#pragma once

#include <memory>

#include "step/simulation.hpp"

namespace plumb::detail {

/// Method direct: trees by TreeStepper, islands with loops by LoopStepper. If `changes_gradient`, settings
/// are of gradient old, time order 2 and an accuracy, and trees that move calmly take mid.
std::unique_ptr<Simulation> make_direct_simulation(const Scene& scene, const Settings& settings,
                                                   bool changes_gradient = false);

}  // namespace plumb::detail
