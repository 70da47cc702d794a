#pragma once

#include "direct/loops/loop_stepper.hpp"

namespace plumb::detail {

/// Brings rods that are off their lengths there, in no time and without a velocity, by about as little as it
/// takes. Particles that lie straight, or in one place, have no direction to give way. They are bent into a
/// bow then, along gravity or across the island. Returns false if rods do not fit together: particles then
/// stay where they are.
bool settle(LoopState& state, LoopWorkspace& work);

}  // namespace plumb::detail
