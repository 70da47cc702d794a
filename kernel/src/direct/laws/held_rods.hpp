#pragma once

#include "direct/loops/loop_stepper.hpp"
#include "direct/trees/tree_state.hpp"

namespace plumb::detail {

// Rods pull along d + theta e, where e is what d changes by in a substep. These add up what fixed particles
// so bore, where pulls are asked for. A mean pull along a mean direction would be something else.

/// Adds what ties held in a substep of `h` (s), with all of work.active.
template <class T>
void hold_rods(TreeState<T>& state, double h, double theta, const TreeWorkspace<T>& work);
/// Adds what ties held in a projection of velocities.
template <class T>
void hold_rod_blows(TreeState<T>& state, const TreeWorkspace<T>& work);

/// Adds what fixed vertices held in a substep, before places change.
void hold_rods(LoopState& state, const SubstepEnd& end, const LoopWorkspace& work);
/// Adds what fixed vertices held in a projection of velocities.
void hold_rod_blows(LoopState& state, const LoopWorkspace& work);

}  // namespace plumb::detail
