#pragma once

#include <cstdint>

#include "plumb/settings.hpp"

/// These limits say when Newton's method on a tree has converged, when it is given up, and what is too stiff
/// for a substep.
namespace plumb::detail::tree_limits {

inline constexpr int most_iterations = 12;
/// Bends that start far from rest need more, as in other islands.
inline constexpr int most_bent_iterations = 30;
/// Where frames are bounded, iterations go on for longer, as long as the change halves within so many of
/// them. That takes fewer halves, and sooner ends what goes round in circles.
inline constexpr int most_bounded_iterations = 20, bounded_patience = 5;
/// There a part is halved only if each piece of the substep could take so many iterations, all as short as
/// its halves.
inline constexpr double least_for_piece = 3;
/// A substep is cut into so many pieces at most, or into fewer once a step's work is spent. A piece that
/// fails is halved, and halves of composed substeps are of second order.
inline constexpr std::uint32_t most_pieces = 1024, most_spent_pieces = 64;
inline constexpr int most_halvings = 10, damped_halvings = 1;
/// After so many solves of one substep the rest of it is left to gradient new. A tree that cannot be solved
/// must not hold up the others.
inline constexpr int most_attempts = 200;
/// After a substep with elastic rods, at first so many that fail are not halved. Each time that halves are no
/// help either, it is twice as many.
inline constexpr std::uint32_t elastic_substeps = 16, most_elastic_substeps = 1024;

/// After a change this small, RMS over particles relative to a rod, the next would be lost in rounding, since
/// convergence is quadratic. For mid it is smaller: what is left of every substep adds up in the energy. At
/// 1e-7 it comes to 2e-9 of the range in 12,000 steps of 100 rods with an end mass of 1000.
template <class T>
double converged_change(Gradient gradient) {
  if (sizeof(T) == 4) return 1e-4;
  return gradient == Gradient::mid ? 1e-8 : 1e-7;
}

/// The last iteration may find this violation, the root of the sum of C^2 relative to the square of a rod.
/// What a sound solve leaves is as small as its change. Rods that stay violated although nothing changes any
/// more contradict each other, or are lost in rounding.
template <class T>
constexpr double solved_residual = sizeof(T) == 8 ? 3e-6 : 3e-3;

/// A change of many rod lengths does not lead back.
inline constexpr double hopeless_change = 30;
/// Where frames are bounded it does not from here on. Of 45,000 tries of random hangings with such a change
/// at first two were solved, with 14 iterations each.
inline constexpr double hopeless_bounded_change = 3;

/// Gradient old breaks where h times the highest frequency is above 2. A substep is cut into pieces below the
/// first of these before it is tried, by the tensions of the last one. Above the second it does not count as
/// solved: between 1.6 and 2 chains with heavy ends gain energy, although each step alone is stable. What is
/// compared is a bound of the frequency (TreeKernels::find_stiffness).
inline constexpr double aimed_frequency = 1.25, highest_frequency = 1.6;

/// A projection takes velocities away, but for what anchors and forces add. One that makes the sum of their
/// squares this many times as large, of masses as they may be, has divided by rounding.
inline constexpr double most_projected_growth = 1e3;

constexpr double square(double a) {
  return a * a;
}

/// Says whether Newton has converged. Its last step found violations with squares that sum to `residual2`,
/// and changed displacements by squares of the mean `change2` (m^2). They stay squares, so that no lane takes
/// a root.
template <class T>
bool has_converged(double change2, double residual2, double scale2, Gradient gradient) {
  return change2 <= square(converged_change<T>(gradient)) * scale2 &&
         residual2 <= square(solved_residual<T> * scale2);
}
/// Says whether a change is too large to lead back, or is not a number.
inline bool is_hopeless(double change2, double scale2, double most = hopeless_change) {
  return !(change2 <= square(most) * scale2);
}

}  // namespace plumb::detail::tree_limits
