#pragma once

#include "direct/loops/loop_stepper.hpp"

namespace plumb::detail {

/// A step (s) that brings rods to their lengths is too short for loads to act.
inline constexpr double projection_step = 1e-9;

/// Brings rods that are off their lengths there, in no time and without a velocity, by about as little as it
/// takes. Particles that lie straight, or in one place, have no direction to give way. They are bent into a
/// bow then, along gravity or across the island. Returns false if rods do not fit together: they then
/// share what they lack, as elastic rods do.
bool settle(LoopState& state, LoopWorkspace& work);

}  // namespace plumb::detail
