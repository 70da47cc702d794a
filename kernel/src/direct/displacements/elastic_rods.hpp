#pragma once

#include <cstdint>

#include "direct/loops/loop_stepper.hpp"

namespace plumb::detail {

/// Says what was found: displacements with rods that gave, or with rigid ones in the end.
enum class Given : std::uint8_t { nothing, elastic, rigid };

/// Finds the displacements work.delta of a substep that begin() and measure_rods() prepared, with gradient
/// new and slightly elastic rods (LoopStepper::advance_elastic()). Where frames are `bounded` rigid rods are
/// tried from there, whose solution is near where they fit together. Where even soft rods have no minimum it
/// counts the substep as unsolved. Nothing is found if displacements are not finite.
Given let_rods_give(LoopState& state, bool bounded, LoopWorkspace& work, Tally& counters);

}  // namespace plumb::detail
