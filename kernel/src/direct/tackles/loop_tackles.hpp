#pragma once

#include <cstdint>
#include <span>

#include "direct/tackles/loop_tackle.hpp"
#include "direct/tackles/tackle_law.hpp"
#include "plumb/layouts/memory.hpp"
#include "plumb/scene.hpp"

namespace plumb::detail {

struct LoopState;
struct LoopWorkspace;
struct SubstepEnd;

/// A cord slides over a pulley to the segment behind it, or back, or sticks to it. Where it does not press on
/// the pulley, or is not turned by it, both segments pull alike.
enum class Slide : std::uint8_t { even, sticks, on, back };

/// A pulley with friction has these numbers while a substep is solved.
struct Pulley {
  double most = 1;  ///< Pulls on both sides have this ratio at most.
  Slide slide = Slide::even;
  Slide blow = Slide::even;  ///< This is how it takes part in a projection of velocities.
};

/// Steps change these numbers of a tackle. Its multiplier follows those of rods in LoopMotion::mu.
struct LoopTackleMotion {
  double length;       ///< At the end of the last substep, in m.
  double rate = 0;     ///< It changes by so much, in m/s.
  double jump = 0;     ///< Its rate changed by so much as the step began, in m/s.
  double impulse = 0;  ///< Pulls times substeps, of this step, in N s.
};

/// Holds what a substep makes of the tackles, while it is solved.
struct TackleWorkspace {
  /// A segment goes from one vertex to the next. `way` leads from the second to the first.
  struct Segment {
    Vec3 way;
    double length;
  };
  Array<Segment> segments;  ///< They are those at the start, of one tackle after the other.
  Array<double> starts;     ///< Sums of segments at the start of a substep, in m.
  Array<double> lengths;    ///< Lengths that hold in this substep, in m.
  Array<Pulley> pulleys;    ///< Those with friction.
  bool are_smooth = false;  ///< Leaves friction out.
};

/// Gives an island the numbers of its tackles, in the order of its topology.
void load_tackles(LoopState& state, const Scene& scene, std::span<const std::uint32_t> tackles);
/// Sets the lengths that tackles have in a substep of `h` (s): rigid ones that of its end, and elastic ones
/// that of its middle.
void set_tackle_lengths(const LoopState& state, double h, TackleWorkspace& work);
/// Measures segments at the start of a substep.
void measure_tackles(const LoopState& state, TackleWorkspace& work);

/// Writes what tackles add to Newton's matrix into `values` of the island's system.
void write_tackles(const LoopState& state, double theta, double soft, const LoopWorkspace& work,
                   std::span<double> values);
/// Adds what tackles pull to the right-hand side, and puts there what their rows lack.
void pull_by_tackles(const LoopState& state, double theta, double soft, const LoopWorkspace& work,
                     std::span<double> right);

/// Writes the rows of a projection of velocities. Cords that give, or did not pull last, do not hold.
void write_projected_tackles(const LoopState& state, const LoopWorkspace& work, std::span<double> values);
/// Puts what these rows lack into the right-hand side.
void lack_of_projected_tackles(const LoopState& state, const LoopWorkspace& work, std::span<double> right);

/// Returns the pivot that a tackle with these values has if give(vertex) says what vertices yield to a force.
template <class Give>
double tackle_pivot(const LoopTackle& tackle, const double* values, Give&& give) {
  double sum = 0;
  for (const std::uint32_t vertex : tackle.vertices) {
    const double* const force = tackle.rubs ? values + 3 : values;  // -A^T is not all there; it is alike
    const double along = force[0] * values[3] + force[1] * values[4] + force[2] * values[5];
    sum += (along < 0 ? -along : along) * give(vertex);
    values += LoopTackle::per_vertex;
  }
  return sum;
}

/// Returns how far the equation of a tackle is off, relative to its length.
double tackle_misfit(const LoopState& state, const LoopWorkspace& work, std::uint32_t tackle);
/// Returns the work in a substep by theta of tackles that give, catch or change their length, in units of
/// delta . M delta.
double work_of_tackles(const LoopState& state, double theta, const LoopWorkspace& work);
/// Returns the energy of all tackles at the end of a substep in which rods give, in the same units.
double energy_of_tackles(const LoopState& state, double soft, const LoopWorkspace& work);
/// Sets the multipliers of all tackles there.
void set_elastic_tackles(LoopState& state, double soft, const LoopWorkspace& work);

/// Ends a substep: adds up lengths and pulls.
void end_tackles(LoopState& state, const SubstepEnd& end, const LoopWorkspace& work);
/// Adds up the pulls of a projection of velocities (LoopWorkspace::blows).
void hold_blows(LoopState& state, const LoopWorkspace& work);

template <class Archive>
void visit_members(Archive& archive, LoopTackleMotion& of) {
  auto& [length, rate, jump, impulse] = of;
  archive(length, rate, jump, impulse);
}
/// The next substep starts from how cords slide in this one.
template <class Archive>
void visit_members(Archive& archive, Pulley& of) {
  auto& [most, slide, blow] = of;
  archive(most, slide, blow);
}

}  // namespace plumb::detail
