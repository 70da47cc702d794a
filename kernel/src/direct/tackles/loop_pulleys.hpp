#pragma once

#include <span>

#include "direct/tackles/cords.hpp"

namespace plumb::detail {

/// Pulleys with friction (Euler, Eytelwein). Behind a pulley the cord pulls `most` times as much as before it
/// where it slides on, 1/most times where it slides back, and something between where it sticks.
///
/// The cord that slid on over a pulley within a substep is by how much all segments behind it grew. So the
/// work of friction is minus the difference of pulls times that, and never positive. Which of the three holds
/// is found together with the pulls: what sticks with too large a difference slides, and what slides the
/// wrong way sticks.

/// An island is looked at while it is solved.
struct PulleyView {
  const LoopState& state;
  const LoopWorkspace& work;
};
/// Says which slide of a pulley holds; none means that all pull alike.
using SlideOf = Slide Pulley::*;

/// Finds the ratios of pulls for a substep, from how far cords turn in its middle. Displacements are those
/// that are expected.
void start_pulleys(const LoopState& state, LoopWorkspace& work);
/// Finds how cords slide at the present displacements and multipliers. Returns whether a pulley switched.
bool set_slides(const LoopState& state, double theta, LoopWorkspace& work);

/// Writes what the pulleys of tackle `t` have in Newton's matrix, into that tackle's values.
void write_pulleys(const Cords& cords, std::uint32_t t, SlideOf slide, const TackleWorkspace& work,
                   double* values);
/// Takes out what they have at vertices that are locked.
void leave_out_locked_pulleys(const LoopState& state, const LoopTackle& tackle, double* values);
/// Puts what their rows lack into the right-hand side.
void lack_of_pulleys(const Cords& cords, std::uint32_t t, SlideOf slide, const PulleyView& of,
                     std::span<double> right);
/// Does so in a projection of velocities (Pulley::blow).
void lack_of_projected_pulleys(const Cords& cords, std::uint32_t t, const PulleyView& of,
                               std::span<double> right);

/// Lets a blow find cords as they slid and stuck in the last substep.
void begin_blow(TackleWorkspace& work);
/// Lets those slide whose blow (LoopWorkspace::blows) is too large for them to stick, and those turn round
/// that a blow makes slide the other way in the mean. Velocities (m/s) were `before`. Returns whether there
/// are any.
bool finds_other_slides(const LoopState& state, std::span<const double> before, LoopWorkspace& work);
/// Lets cords that stick keep so in a projection of velocities, if one of them moves over its pulley at the
/// end of a substep of `h` (s). Returns whether one does.
bool begin_stop(const LoopState& state, double h, LoopWorkspace& work);
/// Lets projections be without friction again.
void end_blow(TackleWorkspace& work);

}  // namespace plumb::detail
