#pragma once

#include "direct/loops/loop_stepper.hpp"

namespace plumb::detail {

/// Finds the displacements work.delta of a substep that begin() and measure_rods() prepared, with gradient
/// new and slightly elastic rods (LoopStepper::advance_elastic()). Where even soft rods have no minimum it
/// counts the substep as unsolved. Returns false if displacements are not finite.
bool let_rods_give(LoopState& state, LoopWorkspace& work, Tally& counters);

}  // namespace plumb::detail
