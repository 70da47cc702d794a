#pragma once

#include <cstdint>

#include "direct/trees/tree_state.hpp"
#include "plumb/settings.hpp"

namespace plumb::detail {

/// Sets the lengths that rods whose length changes have in a substep of `h` (s). Rigid ones take that of its
/// end. Elastic ones take that of its middle, so that their pull is of second order.
template <class T>
void set_substep_lengths(TreeState<T>& state, double h);

/// Lets rigid cables that are hardly slack begin Newton's method as taut ones (drawn_cable).
template <class T>
void draw_cables(TreeState<T>& state);

/// Ends a substep of `h` (s), with all of work.active: adds up lengths and pulls, and breaks rods that pulled
/// more than they hold. `theta` is that of the substep's gradient. Returns how many have broken.
template <class T>
std::uint32_t end_rods(TreeState<T>& state, double h, double theta, const TreeWorkspace<T>& work);

}  // namespace plumb::detail
