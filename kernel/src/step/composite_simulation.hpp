#pragma once

#include <memory>

#include "step/simulation.hpp"

namespace plumb::detail {

/// Method automatic: every island by the method that choose_method() takes for it. Parts that move by
/// different methods share no movable particle and never meet.
std::unique_ptr<Simulation> make_composite_simulation(const Scene& scene, const Settings& settings);

}  // namespace plumb::detail
