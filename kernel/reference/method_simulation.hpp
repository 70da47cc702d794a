#pragma once

#include <memory>

#include "step/simulation.hpp"

namespace plumb::detail {

/// Moves every island by a MechanicalSystem of its own, one after the other on the calling thread.
std::unique_ptr<Simulation> make_method_simulation(const Scene& scene, const Settings& settings);

}  // namespace plumb::detail
