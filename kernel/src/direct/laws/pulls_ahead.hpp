#pragma once

#include "direct/loops/loop_stepper.hpp"
#include "direct/trees/tree_state.hpp"

namespace plumb::detail {

// A substep of gradient old knows pulls at its start, and its displacement is a velocity half a substep
// before its end. The velocity at the end has half a kick more, in which rods pull as they do there (RATTLE,
// Andersen 1983). A step counts that pull ahead of time, and the next one takes it back. What is counted so
// makes the change of velocities to rounding, and is of second order, as the trapezoidal rule is.

/// Returns for how long (s) rods pull with what a substep of `h` (s) of gradient theta finds, after one of
/// `last` (s) or from a velocity (0). With gradient old that is from the middle of the last one to its own.
constexpr double pulled_time(double theta, double h, double last) {
  return theta == 0 ? (h + last) / 2 : h;
}

/// Begins to add up pulls of a step, without those that the last one counted ahead.
template <class T>
void begin_pulls(TreeState<T>& state);
void begin_pulls(LoopState& state);

/// Counts those of a projection to velocities of gradient old. `drag` is in 1/s.
template <class T>
void count_pulls_ahead(TreeState<T>& state, double drag, const TreeWorkspace<T>& work);
void count_pulls_ahead(LoopState& state, double drag, const LoopWorkspace& work);

}  // namespace plumb::detail
