#pragma once

/// How far the substeps of clusters go, and how exactly they are solved. What a user may want otherwise
/// stands in ContactSettings.
namespace plumb::detail::contact_limits {

/// A rod turns by at most so many radians in a substep. Each correction along the gradients of the start then
/// takes a digit off the violation.
inline constexpr double most_turn = 0.35;
/// The same in flight, where it is what accuracy goes by if none is asked for; and where one is.
inline constexpr double most_turn_in_flight = 0.25, most_turn_if_watched = 1;
/// Two shapes that approach do so by at most this share of their radii in a substep.
inline constexpr double most_approach = 0.5;
/// A force that throws an island farther than this many sizes in a step is left out of its reach.
inline constexpr double farthest_throw = 10;
/// A pull that moved an island by more than this share of its size in a substep was a hit. A smaller one is
/// expected again in the next substep.
inline constexpr double farthest_pull = 0.05;
/// A step is cut into no more than so many substeps.
inline constexpr double most_cuts = 4096;
/// A step is cut into no more than so many substeps because one would gain energy.
inline constexpr double most_guards = 64;
/// At rest, a gain of this share of the energy that lifts an island by its size counts as none.
inline constexpr double unnoticed = 3e-9;
/// In free flight an error of this share of the energy is left. Taking it from a rigid whole would change its
/// momentum.
inline constexpr double let_be = 1e-6;
/// Constraints count as solved once they are violated by no more than this share of their lengths.
inline constexpr double exact = 1e-8;
/// A substep makes at most so many corrections of its constraints.
inline constexpr int most_corrections = 16;
/// Change (m, times the length scale) that a last sweep may always make, where nothing weighs anything.
inline constexpr double least_still = 1e-9;
/// Sweeps are this much tighter until the end of the step, once contacts have lifted something.
inline constexpr double tighter = 1e-2;
/// The last of several sweeps may change this share of what the first did. The rest waits for corrections,
/// which change about as much. A share of 0.1 costs 4 % of the step and leaves no less.
inline constexpr double rough = 0.3;
/// A substep sweeps at most so often over its contacts before corrections; after one, a quarter as often.
inline constexpr int most_sweeps = 60;
/// Velocities after contact are swept and corrected in at most so many rounds.
inline constexpr int most_rounds = 4;
/// A place that a push moves by less than this share of what it would move a free linkage by is held.
inline constexpr double held_response = 1e-8;
/// A contact that does not seem to come about in a substep is watched within this distance (m, times the
/// length scale), and within so many times the distance that its ends move.
inline constexpr double sight = 0.1, sight_of_moves = 2;

}  // namespace plumb::detail::contact_limits
