#pragma once

#include <cstdint>
#include <limits>
#include <span>
#include <string>
#include <vector>

#include "interface/state_hash.hpp"
#include "interface/tally.hpp"
#include "plumb/settings.hpp"
#include "plumb/vec3.hpp"
#include "plumb/world.hpp"

namespace plumb::detail {

class Team;

/// Where a solver keeps a particle; every solver numbers its own.
using Slot = std::uint32_t;

/// The straight path of a fixed particle in a step of `dt` seconds, m.
struct AnchorMove {
  Vec3 from, to;
  double dt;

  Vec3 velocity() const { return (1 / dt) * (to - from); }
};

/// How the error of a solver's substeps shows, for the control of accuracy (time/accuracy.hpp).
struct ErrorModel {
  std::uint32_t order = 2;  ///< in time: errors of positions fall with this power of the substep
  /// Errors show when the same time is taken in half as many substeps. If false, Solver::advance() returns an
  /// estimate of its own.
  bool by_comparison = true;
  std::uint32_t most_substeps = 1u << 20;  ///< of a step; shorter ones would be rounding
  /// A substep that needed gradient new was tried at a thousandth of its length before: a finer step would
  /// need it too.
  bool fallback_is_final = false;
};

/// A copy of a piece's motion that a solver keeps: that at the start of a step, or of a window of it.
enum class Saved : std::uint8_t { step, window };

/// Moves islands that are laid out together: a block under relaxation, a lane group of equal trees, an island
/// with loops, or all islands that may touch.
///
/// A solver knows how its islands move through one substep. All else is done once for every solver, above it:
/// places and paths of particles, substeps and accuracy, threads, sleep, the hash and the counts of a step.
///
/// A solver's islands come in pieces that share nothing, so that several threads may advance several pieces
/// at once. Thread `part` of the team uses the working memory of that number.
class Solver {
 public:
  virtual ~Solver() = default;

  // --- Pieces of this step

  virtual std::uint32_t pieces() const { return 1; }
  /// Islands of a piece, for counting.
  virtual std::uint32_t islands(std::uint32_t piece) const = 0;
  virtual std::uint32_t piece_of(Slot) const { return 0; }

  /// Whether pieces are formed anew in begin_step(); islands then sleep as the solver decides.
  virtual bool has_changing_pieces() const { return false; }

  // --- A step, in the order of calls

  /// Once before the pieces of a step of `dt` seconds, after the anchors' paths are known. The team is the
  /// one that will share the step.
  virtual void begin_step(double /*dt*/, Team&) {}
  /// Once before a piece is advanced, by the thread that does it.
  virtual void begin_piece(std::uint32_t /*piece*/, unsigned /*part*/) {}
  /// Advances a piece by `count` substeps of `h` seconds each and adds to `tally` what that took. Returns
  /// the largest error estimate of a substep (m), if the error model has estimates; infinity for substeps
  /// that had to be cut.
  virtual double advance(std::uint32_t piece, double h, std::uint32_t count, unsigned part, Tally& tally) = 0;
  /// Whether the whole team works on each piece; then advance_with_team() is called instead.
  virtual bool wants_team() const { return false; }
  virtual void advance_with_team(double /*h*/, std::uint32_t /*count*/, Team&, StepReport&) {}
  /// Once after a piece went through the step, by the same thread.
  virtual void end_piece(std::uint32_t /*piece*/, double /*dt*/) {}
  /// Once after the pieces of a step, before anchors are put where they went.
  virtual void end_step(StepReport&) {}

  // --- Accuracy; called only if the settings have one

  /// Whether the control of accuracy chooses the substeps; if not, the solver has a way of its own.
  virtual bool takes_accuracy() const { return true; }
  virtual ErrorModel error_model() const { return {}; }
  /// Seconds that the last step found best for a substep; 0 before there was one.
  virtual double& best_substep(std::uint32_t piece) = 0;
  /// Pieces that stability cuts a substep of `h` seconds into.
  virtual std::uint32_t cuts(std::uint32_t /*piece*/, double /*h*/) const { return 1; }
  /// Whether loads or anchors changed what moves a piece, so that what is known of its past says little.
  virtual bool anchors_changed(std::uint32_t /*piece*/) const { return false; }
  virtual bool starts_anew(std::uint32_t piece) const { return anchors_changed(piece); }
  virtual void save(std::uint32_t piece, Saved which) = 0;
  virtual void restore(std::uint32_t piece, Saved which) = 0;
  /// Remembers where particles are, and tells how far from there they have come since: RMS over the
  /// particles of the worst island, m.
  virtual void mark(std::uint32_t piece) = 0;
  virtual double distance_from_mark(std::uint32_t piece) const = 0;
  /// Takes the whole step in another way than the usual, if that is accurate enough: true if it did.
  virtual bool try_calm_step(std::uint32_t /*piece*/, double /*h*/, std::uint32_t /*count*/,
                             double /*allowed*/, unsigned /*part*/, Tally&) {
    return false;
  }
  /// After a controlled step by substeps of `h` with that error each; `longest` is the longest allowed.
  virtual void end_controlled_step(std::uint32_t /*piece*/, double /*error*/, double /*h*/,
                                   double /*longest*/, double /*allowed*/, unsigned /*part*/) {}

  // --- Sleep

  /// Whether a piece may be put to rest at all.
  virtual bool can_rest() const { return true; }
  /// After a piece was woken.
  virtual void wake(std::uint32_t /*piece*/) {}
  /// Whether no particle of a piece moves faster than `speed` (m/s).
  virtual bool is_slower(std::uint32_t piece, double speed) const = 0;
  /// Takes the velocities from a piece that does not move but by rounding.
  virtual void rest(std::uint32_t piece) = 0;
  /// m; what a speed that is only rounding is relative to.
  virtual double size(std::uint32_t piece) const = 0;

  // --- Particles

  virtual Vec3 position(Slot) const = 0;
  virtual Vec3 velocity(Slot) const = 0;
  virtual void add_to_hash(Slot, StateHash&) const = 0;
  /// Positions (m) of many particles into `out`. Returns about the speed (m/s) of the fastest: that of the
  /// last substep, which costs no projection.
  virtual double read(std::span<const Slot> slots, std::span<Vec3> out) const = 0;
  virtual void set_force(Slot, Vec3 newton) = 0;
  /// Gives a fixed particle its path through the next step.
  virtual void move_anchor(Slot, const AnchorMove&) = 0;
  /// Once all paths of a step are set, and once after the step: fixed particles are at their targets exactly.
  virtual void begin_anchors() {}
  virtual void end_anchors() {}
  virtual void place_anchor(Slot, Vec3 target) = 0;
  /// Position and velocity of a movable particle, all of which an island gets at once.
  virtual void set_motion(Slot, Vec3 position, Vec3 velocity) = 0;
  /// Leaves the island of a particle out of steps, or takes it in again: another solver moves it.
  virtual void set_away(Slot, bool away) = 0;
  /// Whether all islands of a piece are left out.
  virtual bool is_away(std::uint32_t piece) const = 0;

  // --- Settings and reports

  /// Whether rods are moved by sweeps, so that the stop rule says how much work there is.
  virtual bool sweeps() const { return false; }
  virtual bool set_stop_rule(const StopRule&) { return false; }  ///< true if it is read
  virtual bool set_weights(Weights) { return false; }            ///< true if they are read
  /// Adds what is laid out here: blocks, rods by method, what is skipped.
  virtual void describe(WorldInfo&) const = 0;
};

}  // namespace plumb::detail
