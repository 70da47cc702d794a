#pragma once

#include <cstdint>
#include <span>

#include "direct/reels/loop_reel.hpp"
#include "plumb/scene.hpp"

namespace plumb::detail {

struct LoopState;
struct LoopWorkspace;
struct SubstepEnd;

// Reels let rods and particles of a chain come out of a drum and go back. What is equal in all states is the
// topology: every rod and particle of the chain is always there.
//
// A particle of the chain is wound, carried or free.
// - Wound particles are locked (Locks) where the drum is, and their rods pull nothing.
// - The rod from the last locked particle to the first free one is the rod that leaves the drum. Its length
//   follows from what is out, and its stiffness is that of the piece of rope that it stands for.
// - When that rod becomes longer than it was made, the next particle is on it. It is carried along the line
//   from the drum to the first free particle, where its share of the rod is. Its mass then acts on that
//   neighbour, but it adds no equation: it is locked, and the line's displacement says its own.
// - When it is half a rod out of the drum it becomes free, where it is and as fast as it is. Nothing else
//   changes its place or its velocity.
//
// Particles that come in go the same way back. One that comes round a corner cuts it when it becomes carried.
// Then the new rod begins with the length that it has, and with the rate that it has. So nothing that is out
// changes its place or its velocity, and what was cut is wound in while the drum turns on.
//
// A substep ends where a particle becomes free or carried, since accelerations jump there. That keeps the
// order in time.

/// Gives an island the numbers of its reels, in the order of its topology, and puts wound particles on drums.
void load_reels(LoopState& state, const Scene& scene, std::span<const std::uint32_t> reels);
/// Begins to count what drums hold, once all velocities are set.
void begin_reels(LoopState& state);
/// Sets what is out (m), and its rate (m/s). The rod that leaves the drum notes how its own rate jumps.
void turn_reel(LoopState& state, std::uint32_t reel, double out, double rate);
/// Puts wound particles where their drum is.
void place_wound(LoopState& state);
/// Makes what is not in LoopMotion fit it.
void restore_reels(LoopState& state);

/// Sets the rates with which rods leave drums in a substep of h (s).
void set_reel_lengths(LoopState& state, double h);
/// Lets carried particles act in a substep whose lengths are set, on masses and loads. Displacements before
/// it go into it `ratio` times, and forces by `kick` (s^2).
struct SubstepStart {
  double h, ratio, kick;
};
void start_reels(LoopState& state, const SubstepStart& start, LoopWorkspace& work);
/// Ends a substep: what is out, and what drums held.
void end_reels(LoopState& state, const SubstepEnd& end, const LoopWorkspace& work);
/// Returns when, within h (s), the next particle becomes free or carried, or h.
double next_reel_event(const LoopState& state, double h);
/// Lets particles become free or carried that would within `soon` (s). Returns whether there were any, and
/// whether velocities do not fit the rods any more.
struct ReelEvents {
  bool any = false, jolts = false;
};
ReelEvents pass_reel_events(LoopState& state, double soon);

/// Notes velocities before a projection, and adds up what drums held in it.
void note_reel_blows(const LoopState& state, LoopWorkspace& work);
void hold_reel_blows(LoopState& state, const LoopWorkspace& work);

/// Returns the place of a vertex that may be carried, in m.
Vec3 reeled_position(const LoopState& state, std::uint32_t vertex);
/// Returns its velocity, in m/s, among `velocities` of nodes.
Vec3 reeled_velocity(const LoopState& state, std::uint32_t vertex, std::span<const double> velocities);
/// Returns whether a rod is wound, so that it pulls nothing.
bool is_wound(const LoopState& state, std::uint32_t rod);
/// Returns the strain of a rod that reads `strain` by the places of its ends and the scene's length.
double reeled_strain(const LoopState& state, std::uint32_t rod, double strain);

}  // namespace plumb::detail
