#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <string>
#include <string_view>
#include <vector>

#include "plumb/export.hpp"
#include "plumb/settings.hpp"
#include "plumb/vec3.hpp"

/// @file
/// This file holds what a world reports of itself: of a step, of how its scene was compiled, of problems, of
/// what is added, and of how bodies move.
namespace plumb {

/// Names a Particle, a Rod or the like of a World for good, where numbers are given anew once what had them
/// is removed. It is a value, and one without members set names nothing.
template <class Item>
struct Handle {
  std::uint32_t number = 0;      ///< Its number in the world.
  std::uint32_t generation = 0;  ///< Odd, and higher the later it got the number; 0 if it names nothing.

  /// Returns whether it names something, which may be gone by now.
  explicit constexpr operator bool() const { return generation != 0; }
  /// Returns whether both name the same.
  friend constexpr bool operator==(const Handle&, const Handle&) = default;
};

/// Says how a body moves (World::motion()).
struct BodyMotion {
  Vec3 velocity{};  ///< Velocity of its centre of mass, in m/s.
  Vec3 spin{};      ///< Angular velocity in the axes of space, in rad/s.

  /// Returns whether all members are equal.
  friend constexpr bool operator==(const BodyMotion&, const BodyMotion&) = default;
};

/// Says which numbers World::add() gave. Those of each kind follow each other in the order of what was added.
/// Where none of a kind was added, its number means nothing.
struct Added {
  std::uint32_t particle = 0;   ///< Number of the first particle.
  std::uint32_t rod = 0;        ///< Number of the first rod.
  std::uint32_t bend = 0;       ///< Number of the first bend.
  std::uint32_t tackle = 0;     ///< Number of the first tackle.
  std::uint32_t body = 0;       ///< Number of the first body.
  std::uint32_t pin = 0;        ///< Number of the first pin.
  std::uint32_t alignment = 0;  ///< Number of the first alignment.
  std::uint32_t angle = 0;      ///< Number of the first angle.
  std::uint32_t spring = 0;     ///< Number of the first spring.
  std::uint32_t torsion = 0;    ///< Number of the first torsion.
  std::uint32_t capsule = 0;    ///< Number of the first capsule.
  std::uint32_t hull = 0;       ///< Number of the first hull.

  /// Returns whether all members are equal.
  friend constexpr bool operator==(const Added&, const Added&) = default;
};

/// Says what ended the sweeps. Where blocks or substeps differ, the latest in this list is reported.
enum class StoppedBy : std::uint8_t { nothing, tolerance, sweeps, budget };
/// Returns the name of what ended the sweeps, as reports spell it.
PLUMB_API std::string_view to_string(StoppedBy);

/// Says what one step did and what it skipped. Counts add up over substeps and blocks.
struct StepReport {
  std::uint64_t substeps = 0;                 ///< Substeps of the step, once for the world.
  std::uint64_t block_sweeps = 0;             ///< Sweeps over a block, summed over blocks and substeps.
  std::uint64_t rod_projections = 0;          ///< Rods projected, without padding.
  StoppedBy stopped_by = StoppedBy::nothing;  ///< What ended the sweeps.
  /// Counts blocks, times substeps, that were within tolerance after prediction and were not swept.
  std::uint64_t skipped_within_tolerance = 0;
  /// Counts substeps of a block in which gradient mid did not converge. Their velocity is that of the step
  /// itself.
  std::uint64_t mid_guarded = 0;
  /// Counts islands that went non-finite in this step. Each was put back to its last finite state and stands
  /// still.
  std::uint32_t frozen_islands = 0;

  // The next members count what direct solves did. Of what is repeated for accuracy, `newton` alone counts
  // all attempts.
  std::uint64_t direct_substeps =
      0;  ///< Substeps that islands took. Each piece of a cut one counts, an elastic one does not.
  std::uint64_t newton = 0;    ///< Newton steps, summed over islands.
  std::uint64_t halvings = 0;  ///< Substeps of an island that did not converge, or turned too far, and were
                               ///< cut. Relaxed ones, too, that a blow would tear or let something pass.
  /// Counts substeps that were taken in a way that damps, because they, or some just before, did not
  /// converge. That is gradient new or, where things touch, a looser grip or relaxation.
  std::uint64_t fallbacks = 0;
  std::uint64_t repeated_steps = 0;  ///< Steps of islands that were repeated, finer, to be accurate enough.
  /// Substeps of islands whose rods did not fit together, taken with slightly elastic rods, or relaxed where
  /// they touch: what they lack is shared.
  std::uint64_t elastic_substeps = 0;
  /// Substeps that elastic rods did not solve either. What is finite is taken all the same, and what is not
  /// stays where it was. Method multipliers counts projections that did not converge.
  std::uint64_t unsolved = 0;
  /// Counts steps that were taken although they were not accurate enough, because shorter ones could not be
  /// better. Islands and adaptive_implicit_euler count here.
  std::uint64_t inaccurate_steps = 0;
  /// Counts steps of islands, or of islands side by side, that spent Settings::most_work, or half of it in
  /// tries for an accuracy, and those that a budget cut short. They ended with the substeps that are asked
  /// for by number, or with fewer.
  std::uint64_t capped_steps = 0;

  // The next two members are known where World::set_budget() gave one.
  double step_us = 0;  ///< Wall time of the step, in microseconds.
  /// Wall time that all substeps would have taken which were asked for by number, as far as steps of other
  /// numbers of them tell. With an accuracy it is that of the step.
  double asked_us = 0;

  std::uint64_t broken_rods = 0;  ///< Rods that pulled more than their strength and broke.

  // The next two members describe method springs at the end of a step. Of several steps or islands the worst
  // counts.
  double largest_gap = 0;  ///< Largest gap between ends of rigid rods that should meet, in m (figure 4.5).
  double rms_gap = 0;      ///< Root mean square of these gaps over the joints of an island, in m.

  // The next members describe scenes with shapes that touch.
  /// Most points at which something pushed in one cluster's substep. A pair of World::contacts() may touch at
  /// several of them.
  std::uint64_t contact_points = 0;
  /// Substeps in which contact would have gained more than a hundredth of the energy of motion, and was held
  /// back. So are springs, bends and rods that give which would have gained a quarter.
  std::uint64_t guarded_energy = 0;
  /// Other substeps whose energy was held back: by less, as the order of a substep explains, or out of
  /// contact.
  std::uint64_t trimmed_energy = 0;
  /// Substeps that ended with something beyond ground it was not to pass, although they were solved again.
  std::uint64_t missed_contacts = 0;
  // The next two count all islands.
  std::uint32_t awake_islands = 0;  ///< Islands awake at the end of the step.
  std::uint32_t fell_asleep = 0;    ///< Islands that fell asleep in this step.

  /// Adds the counts of another step and keeps the worst of what is not a count.
  PLUMB_API StepReport& operator+=(const StepReport& other);
};

/// Hears of the stages of a step when one begins and when it ends, for a profiler's zones
/// (World::set_zones()). Names last as long as the program. Calls come from the thread that steps.
using Zones = std::function<void(std::string_view stage, bool begins)>;

/// Says whether a line of a log tells of something that goes wrong, or of something else.
enum class LogLevel : std::uint8_t { info, warning };
/// Hears in words what goes wrong in a world, and when that ends (World::set_log()). A line is valid during
/// the call, which comes from the thread that steps.
using Log = std::function<void(LogLevel level, std::string_view line)>;

/// Says how one block of a scene is laid out, for `plumb info` and reports.
struct BlockInfo {
  std::string shape;                ///< chain, grid, lanes (equal islands side by side), graph or linkage.
  std::string layout;               ///< aos, soa or aosoa.
  std::uint32_t islands = 0;        ///< Islands in the block.
  std::uint32_t particles = 0;      ///< Particles of these islands.
  std::uint32_t rods = 0;           ///< Rods of these islands.
  std::uint32_t colors = 0;         ///< Colours that a sweep visits.
  std::size_t bytes = 0;            ///< Size of state and rods with padding, in bytes.
  double bytes_per_projection = 0;  ///< Bytes that one rod's projection reads and writes, before any cache.
  double uniform_fraction = 0;      ///< Share of rods that need no length and weights of their own.
};
/// Says how a scene was compiled, for `plumb info` and reports.
struct WorldInfo {
  std::uint32_t particles = 0;     ///< Particles of the scene.
  std::uint32_t rods = 0;          ///< Rods of the scene.
  std::uint32_t islands = 0;       ///< Islands of the scene.
  Isa isa = Isa::scalar;           ///< Instruction set in use.
  unsigned threads = 1;            ///< Threads that may be used.
  bool parallel = false;           ///< Whether they are: the scene is large enough for threads to win.
  std::uint32_t relaxed_rods = 0;  ///< Rods moved by method relax.
  std::uint32_t direct_rods = 0;   ///< Rods moved by method direct.
  Gradient direct_gradient = Gradient::mid;  ///< Gradient that method direct takes.
  bool changes_gradient = false;             ///< Whether some trees take mid while they are calm.
  std::uint32_t direct_time_order = 2;  ///< Time order of direct; under automatic that of the first islands.
  std::uint32_t linkages =
      0;  ///< Kinds of islands that the contact solver alone moves, as those with bodies.
  std::uint64_t skipped_per_rod_weights = 0;  ///< Rods in uniform ranges, whose weights are not read.
  bool skipped_drag = true;                   ///< Whether no displacement is multiplied by drag.
  /// Initial velocities changed by at most this much, in m/s, so that none pulls on a rod.
  double projected_velocity = 0;
  /// Initial positions changed by at most this much, in m, so that rods start at their lengths. Method direct
  /// makes the change on islands of particles and rods.
  double projected_position = 0;
  std::uint32_t unprojected_islands = 0;  ///< Islands whose rods do not fit, and share what they lack.
  std::vector<BlockInfo> blocks;          ///< Blocks; equal ones are listed once, with their sums.
  /// Bytes that the world has got for its arrays, used or not. The scene is not among them, nor are lists of
  /// a few things in trees.
  std::size_t memory = 0;
};

/// Says what went wrong in the last step of a World (World::problems()), or in the last one before its island
/// fell asleep as it froze or did not fit.
struct Problem {
  /// `frozen`: numbers of an island went non-finite, and it stands still. `unsolved`: a substep was not
  /// solved. `elastic`: a substep had no place for rods at their lengths, or none was found. Rods share what
  /// they lack. `inaccurate`: a step was taken though not accurate enough. `capped`: an island spent
  /// Settings::most_work. `stretched`: a rod that is not elastic is off its length.
  enum class Kind : std::uint8_t { frozen, unsolved, elastic, inaccurate, capped, stretched };

  Kind kind = Kind::unsolved;
  /// It is the first movable particle of the island. Equal islands that are solved side by side are told of
  /// by the first of them. So are islands that touch, of what is `unsolved`, `inaccurate` or `capped`. For a
  /// rod it is the rod's first movable end.
  std::uint32_t particle = 0;
  std::uint32_t rod = 0;  ///< The rod, if it is stretched.
  double strain = 0;      ///< Its strain, without a unit; negative if it is too short.
};
/// Returns the name of a kind of problem, as reports spell it.
PLUMB_API std::string_view to_string(Problem::Kind);

/// Says what became of an island or of a rod in the last step of a World (World::events()).
struct Event {
  /// `woke` and `fell_asleep`: an island was asleep at the end of one of the last two steps and not of the
  /// other. What a program adds asleep, or removes, is no event. `broke`: a rod pulled more than its
  /// strength; those that World::cut() takes out are not listed. The others are as Problem::Kind has them.
  enum class Kind : std::uint8_t { woke, fell_asleep, broke, frozen, unsolved, elastic, inaccurate, capped };

  Kind kind = Kind::woke;
  /// It is the first movable particle of the island; what went wrong is told of the one that Problem names.
  /// For a rod it is the rod's first movable end.
  std::uint32_t particle = 0;
  std::uint32_t rod = 0;  ///< The rod, if it broke.
  double strength = 0;    ///< What the rod held, in N, if it broke: it pulled more.

  /// Returns whether all members are equal.
  friend constexpr bool operator==(const Event&, const Event&) = default;
};
/// Returns the name of a kind of event, as files spell it.
PLUMB_API std::string_view to_string(Event::Kind);

}  // namespace plumb
