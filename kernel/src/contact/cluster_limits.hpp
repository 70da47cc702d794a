#pragma once

/// How far the steps of groups go, and how exact they are.
namespace plumb::detail::contact_limits {

/// Radians that a rod turns by in a substep, at most: corrections along the gradients of the start then take
/// a digit off what is left every time.
inline constexpr double most_turn = 0.35;
/// Of the radii of two that approach, how far they do in a substep.
inline constexpr double most_approach = 0.5;
/// Of its size, how far a force throws an island in a step, at most, for others to be looked for there.
inline constexpr double farthest_throw = 10;
/// Of its size, how far what pulls moves an island in a substep, at most, to be expected in the next again:
/// farther it was a hit.
inline constexpr double farthest_pull = 0.05;
/// A step is cut into no more than so many.
inline constexpr double most_cuts = 4096;
/// Nor into more because it would gain energy.
inline constexpr double most_guards = 64;
/// Of a weight's energy, gained at rest.
inline constexpr double unnoticed = 3e-9;
/// Of a motion's energy, left in free flight rather than taken from a rigid whole, whose momentum it would
/// be.
inline constexpr double let_be = 1e-6;
/// Left of constraints, relative to lengths.
inline constexpr double exact = 1e-8;
/// The same in shares of composed substeps, whose errors would otherwise hide the higher order.
inline constexpr double exact_in_shares = 1e-13;
inline constexpr int most_corrections = 16;
/// What a sweep may still change when it is the last, of what gravity does in a substep, and in m. Toppling
/// figures then lie within 0.1 mm of where tighter sweeps leave them after 1.6 s, and 30 mm from where twice
/// as many substeps do; a block slides at the right slope to 1 % up to about 5e-3.
inline constexpr double still = 4e-3, least_still = 1e-9;
/// Of that, once something was lifted: then until the end of the step.
inline constexpr double tighter = 1e-2;
/// Of what the first of several sweeps changes, what the last may: the rest waits for what they will be
/// corrected by, which changes about as much. Less costs more sweeps (0.1: 4 % of the step), and leaves no
/// less.
inline constexpr double rough = 0.3;
inline constexpr int most_sweeps = 60;
inline constexpr int most_rounds = 4;
/// Left of contacts, m, a substep is taken again, shorter.
inline constexpr double too_much = 1e-5;
/// Of what a push does on a linkage that is free to go, less than this is none: it is held all round.
inline constexpr double held_response = 1e-8;
/// Slower than this nothing bounces, m/s: it would for ever.
inline constexpr double least_bounce = 0.05;
/// What is near enough to be kept from touching, m.
inline constexpr double margin = 2e-3;
/// Overlap beyond this is taken back, m; and of it, and of what is beyond a limit, the share taken back in a
/// substep of the length asked for. In shorter ones less in proportion, or the speed it takes would grow as
/// they shrink.
inline constexpr double most_overlap = 5e-4, taken_back = 0.1;
/// What does not seem to touch in a substep is watched if it is nearer, m: so far, and so many times as it
/// moves.
inline constexpr double sight = 0.1, sight_of_moves = 2;

}  // namespace plumb::detail::contact_limits
