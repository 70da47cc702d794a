#pragma once

#include <memory>

#include "simulation.hpp"

namespace plumb::detail {

/// Method direct. Throws NotBuiltError on islands with loops.
std::unique_ptr<Simulation> make_direct_simulation(const Scene& scene, const Settings& settings);

}  // namespace plumb::detail
