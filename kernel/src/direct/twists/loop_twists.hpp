#pragma once

#include <cstdint>
#include <span>

#include "direct/loops/loop_rod.hpp"
#include "direct/twists/loop_twist.hpp"
#include "plumb/layouts/memory.hpp"

namespace plumb::detail {

struct BendTable;
class IslandRods;
struct LoopState;
struct LoopWorkspace;
struct SubstepEnd;

/// An island has these numbers of a twisted chain.
struct LoopTwistNumbers {
  double stiffness;                ///< G J/length, in units of the mass unit times m²/s².
  Array<std::uint32_t> rods;       ///< They are the island's rods. If one is broken, nothing is twisted.
  double imposed = 0, target = 0;  ///< The last cross section is turned to the second in this step, in rad.
  double rate = 0;                 ///< It is turned so fast, in rad/s.
};

/// A substep twists a chain by these numbers. Its torque times the kick of a substep is an unknown of
/// Newton's method, in units of the mass unit times m².
struct TwistSubstep {
  double stiffness = 0;  ///< It is times the kick.
  double start = 0;      ///< Where its torque is taken the chain would be twisted so far if nothing turned.
  double torque = 0;
};

/// Returns the numbers of a twist of the scene where a mass of 1 counts as `mass_unit` (kg). It has no rods.
LoopTwistNumbers twist_numbers(const BendTable& table, std::uint32_t twist, double mass_unit);

/// Gives an island the numbers of its twists, in the order of its topology.
void load_twists(LoopState& state, const BendTable& table, const IslandRods& rods,
                 std::span<const std::uint32_t> twists);

/// Turns the ends of chains to their targets in a step of dt (s), and lets them stand there.
void begin_twists(std::span<LoopTwistNumbers> twists, double dt);
void finish_twists(std::span<LoopTwistNumbers> twists);

/// Returns what a substep of h (s) twists a chain by that is twisted so far (rad).
TwistSubstep twist_substep(const LoopTwistNumbers& twist, double twisted, double h, double kick, bool is_mid);

/// Starts a substep of h (s), whose torques are those of the chains as they are.
void start_twists(const LoopState& state, double h, LoopWorkspace& work);

/// Writes what twists add to Newton's matrix into `values` of the island's system.
///
/// The torque of gradient mid is that of the mean twist, and pulls along the middle position; that of new is
/// both at the end. `gives` asks for the chain's linear response, which is definite.
void write_twists(const LoopState& state, double theta, bool gives, const LoopWorkspace& work,
                  std::span<double> values);

/// Adds what twists pull to the right-hand side, and writes the torques' own.
void pull_by_twists(const LoopState& state, double theta, bool gives, const LoopWorkspace& work,
                    std::span<double> right);

/// Adds `scale` times Newton's change to torques.
void change_torques(const LoopState& state, double scale, std::span<const double> change,
                    LoopWorkspace& work);
/// Sets torques to what the chain's linear response is at work.delta.
void set_linear_torques(const LoopState& state, LoopWorkspace& work);

/// Returns the work of twists in a substep of gradient mid. Joints turn by `least` at least for its scale.
LoopWork work_of_twists(const LoopState& state, const LoopWorkspace& work, double least);
/// Returns the energy of the chains' linear response at the end of a substep, in units of delta . M delta.
double energy_of_twists(const LoopState& state, const LoopWorkspace& work);

/// Ends a substep, before positions change: twists chains by what it turned, and adds up what they ask of
/// fixed vertices.
void end_twists(LoopState& state, const SubstepEnd& end, const LoopWorkspace& work);

template <class Archive>
void visit_members(Archive& archive, LoopTwistNumbers& of) {
  auto& [stiffness, rods, imposed, target, rate] = of;
  archive(imposed, target, rate);
}

}  // namespace plumb::detail
