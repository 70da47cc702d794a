#pragma once

#include <cstdint>
#include <limits>
#include <span>
#include <string>

#include "interface/grab.hpp"
#include "interface/place.hpp"
#include "interface/state_hash.hpp"
#include "interface/tally.hpp"
#include "plumb/layouts/memory.hpp"
#include "plumb/settings.hpp"
#include "plumb/vec3.hpp"
#include "plumb/world.hpp"
#include "time/leftovers.hpp"

namespace plumb::detail {

class Archive;
class Team;

/// Says where a solver keeps a particle. Every solver numbers its own.
using Slot = std::uint32_t;

/// A grabbed place is a sum of particles, each by a share.
struct GrabShare {
  Slot slot;
  double share;
};

/// This is the straight path (m) of a fixed particle in a step of `dt` (s).
struct AnchorMove {
  Vec3 from, to;
  double dt;

  Vec3 velocity() const { return (1 / dt) * (to - from); }
};

/// Says how the error of a solver's substeps shows, for the control of accuracy (time/accuracy.hpp).
struct ErrorModel {
  std::uint32_t order = 2;  ///< order in time: errors of positions fall with this power of the substep
  /// If true, errors show when the same time is taken in half as many substeps. If false, Solver::advance()
  /// returns an estimate of its own.
  bool by_comparison = true;
  std::uint32_t most_substeps = 1u << 20;  ///< substeps of a step; shorter ones would be rounding
  /// Says whether a finer step would fall back too. It would if a substep that fell back to gradient new was
  /// tried at a thousandth of its length before.
  bool fallback_is_final = false;
};

/// Names a copy of a piece's motion that a solver keeps: that at the start of a step, or of a window of it.
enum class Saved : std::uint8_t { step, window };

/// Moves islands that are laid out together: a block under relaxation, a lane group of equal trees, an island
/// with loops, or all islands that may touch.
///
/// A solver knows how its islands move through one substep. All else is done once for every solver, above it:
/// places and paths of particles, substeps and accuracy, threads, sleep, the hash and the counts of a step.
///
/// A solver's islands come in pieces that share nothing, so that several threads may advance several pieces
/// at once. Thread `part` of the team uses the working memory of that number.
class Solver : public InMemory {
 public:
  virtual ~Solver() = default;

  // --- Pieces of this step

  virtual std::uint32_t pieces() const { return 1; }
  /// Returns how many islands a piece has, for counting.
  virtual std::uint32_t islands(std::uint32_t piece) const = 0;
  virtual std::uint32_t piece_of(Slot) const { return 0; }
  /// Returns which of the solver's islands has a particle.
  virtual std::uint32_t island_of(Slot) const { return 0; }

  /// Returns whether begin_step() forms pieces anew. Islands then sleep as the solver decides.
  virtual bool has_changing_pieces() const { return false; }

  // --- A step, in the order of calls

  /// Prepares a step of `dt` (s). It is called once before its pieces, when the anchors' paths are known.
  /// `team` will share the step.
  virtual void begin_step(double /*dt*/, Team&) {}
  /// Prepares a piece. The thread that will advance the piece calls it once.
  virtual void begin_piece(std::uint32_t /*piece*/, unsigned /*part*/) {}
  /// Advances a piece by `count` substeps of `h` (s) each and adds to `tally` what that took. Returns the
  /// largest error estimate of a substep (m) if the error model has estimates. The result is infinite for
  /// substeps that had to be cut.
  virtual double advance(std::uint32_t piece, double h, std::uint32_t count, unsigned part, Tally& tally) = 0;
  /// Returns whether the whole team works on each piece. Then advance_with_team() is called instead.
  virtual bool wants_team() const { return false; }
  virtual void advance_with_team(double /*h*/, std::uint32_t /*count*/, Team&, StepReport&) {}
  /// Ends a piece's step. The thread that advanced the piece calls it once.
  virtual void end_piece(std::uint32_t /*piece*/, double /*dt*/, unsigned /*part*/) {}
  /// Ends a step. It is called once after all pieces, before anchors are put where they went.
  virtual void end_step(StepReport&) {}

  // --- Accuracy; called only if the settings have one

  /// Returns whether the control of accuracy chooses the substeps. If not, the solver has a way of its own.
  virtual bool takes_accuracy() const { return true; }
  virtual ErrorModel error_model() const { return {}; }
  /// Returns the substep (s) that the last step found best, or 0 before there was one. The control writes it.
  virtual double& best_substep(std::uint32_t piece) = 0;
  /// Returns into how many pieces stability cuts a substep of `h` (s).
  virtual std::uint32_t cuts(std::uint32_t /*piece*/, double /*h*/) const { return 1; }
  /// Returns whether loads or anchors changed what moves a piece, so that its past says little.
  virtual bool anchors_changed(std::uint32_t /*piece*/) const { return false; }
  virtual bool starts_anew(std::uint32_t piece) const { return anchors_changed(piece); }
  virtual void save(std::uint32_t piece, Saved which) = 0;
  virtual void restore(std::uint32_t piece, Saved which) = 0;
  /// Remembers where particles are. distance_from_mark() returns how far they have come since, as the RMS (m)
  /// over the particles of the worst island.
  virtual void mark(std::uint32_t piece) = 0;
  virtual double distance_from_mark(std::uint32_t piece) const = 0;
  /// Takes the whole step in another way than the usual if that is accurate enough. Returns whether it did.
  virtual bool try_calm_step(std::uint32_t /*piece*/, double /*h*/, std::uint32_t /*count*/,
                             double /*allowed*/, unsigned /*part*/, Tally&) {
    return false;
  }
  /// Tells the end of a controlled step: its substeps of `h` (s), the error (m) of each, and the longest
  /// substep allowed (s).
  virtual void end_controlled_step(std::uint32_t /*piece*/, double /*error*/, double /*h*/,
                                   double /*longest*/, double /*allowed*/, unsigned /*part*/) {}

  // --- Sleep

  /// Returns whether a piece may be put to rest at all.
  virtual bool can_rest() const { return true; }
  /// The world calls this after a piece was woken.
  virtual void wake(std::uint32_t /*piece*/) {}
  /// Returns whether no particle of a piece moves faster than `speed` (m/s).
  virtual bool is_slower(std::uint32_t piece, double speed) const = 0;
  /// Takes the velocities from a piece that moves by rounding only.
  virtual void rest(std::uint32_t piece) = 0;
  /// Returns the size (m) of a piece, to which a speed that is only rounding is relative.
  virtual double size(std::uint32_t piece) const = 0;

  // --- Particles

  virtual Vec3 position(Slot) const = 0;
  virtual Vec3 velocity(Slot) const = 0;
  virtual void add_to_hash(Slot, StateHash&) const = 0;
  /// Returns where in its memory a solver has a particle, in a measure of its own. Particles that are evenly
  /// apart there are read together.
  virtual std::uint32_t address(Slot slot) const { return slot; }
  /// Reads the positions (m) of particles of this solver, or their velocities (m/s), to their numbers in
  /// `out`.
  virtual void read_positions(std::span<const Run> runs, Vec3* out) const {
    for (const Run& run : runs) run.read_slots(out, [&](Slot slot) { return position(slot); });
  }
  virtual void read_velocities(std::span<const Run> runs, Vec3* out) const {
    for (const Run& run : runs) run.read_slots(out, [&](Slot slot) { return velocity(slot); });
  }
  /// Reads the positions (m) of many particles into `out`. Returns about the speed (m/s) of the fastest, that
  /// of the last substep, which costs no projection.
  virtual double read(std::span<const Slot> slots, std::span<Vec3> out) const = 0;
  virtual void set_force(Slot, Vec3 newton) = 0;
  /// Changes gravity (m/s^2) by `change`. Solvers with an archive do. Forces must be set anew then.
  virtual void set_gravity(Vec3 /*gravity*/, Vec3 /*change*/) {}
  /// Gives a fixed particle its path through the next step.
  virtual void move_anchor(Slot, const AnchorMove&) = 0;
  /// Is called once all paths of a step are set, and once after the step, when fixed particles are at their
  /// targets exactly.
  virtual void begin_anchors() {}
  virtual void end_anchors() {}
  virtual void place_anchor(Slot, Vec3 target) = 0;
  /// Sets position (m) and velocity (m/s) of a movable particle. All particles of an island get theirs at
  /// once.
  virtual void set_motion(Slot, Vec3 position, Vec3 velocity) = 0;
  /// Says what substeps left behind beside the motion of a particle.
  struct Past {
    double substep = 0;     ///< s, the last; 0 if the velocity is that of now, and not its mean
    Leftovers leftovers{};  ///< of sweeps
  };
  virtual Past past(Slot) const { return {}; }
  /// Says that the motion which was set has such a past. It is called once all motion is set.
  virtual void go_on(Slot, const Past&) {}
  /// Lets motion that was set fit rods as at a start, without a blow, if the solver does so. `is_off` says
  /// whether some rod is off its length.
  virtual void fit(bool /*is_off*/) {}
  /// Takes the island of a particle out for good, since another solver has it now.
  virtual void remove(Slot slot) { set_away(slot, true); }
  /// Leaves the island of a particle out of steps while another solver moves it, or takes it in again.
  virtual void set_away(Slot, bool away) = 0;
  /// Returns whether all islands of a piece are left out.
  virtual bool is_away(std::uint32_t piece) const = 0;

  // --- Grabs, by the world's numbers; of solvers that have an archive

  /// Returns why a place can not be grabbed that `slots` of this solver make up, or null if it can.
  virtual const char* refuses_grab(std::span<const Slot> /*slots*/) const {
    return "is moved by a method that takes no grabs; relax, direct and auto do";
  }
  /// Pulls a place from now on, by shares of its slots that add up to 1.
  virtual void put_grab(const HeldGrab&, std::span<const GrabShare>) {}
  virtual void end_grab(std::uint32_t /*number*/) {}
  /// Lets a target go at `velocity` (m/s) in the next step, and puts it where it went after that.
  virtual void aim_grab(std::uint32_t /*number*/, Vec3 /*velocity*/) {}
  virtual void place_grab(std::uint32_t /*number*/, Vec3 /*target*/) {}
  /// Returns what it did in the last step; null if it does not know.
  virtual const HeldGrab* held_grab(std::uint32_t /*number*/) const { return nullptr; }

  // --- Rods, tackles and reels, by slots of their own; of solvers that have them (MadeSolver::cords)

  /// Adds up how cords pull from now on.
  virtual void count_pulls() {}
  /// Returns the force (N) that holds a fixed particle, averaged over the last step of `dt` (s). It is zero
  /// unless pulls are added up, and where another solver holds the island.
  virtual Vec3 hold(Slot, double /*dt*/) const { return {}; }
  /// Returns whether hold() has what rods pull with. Else a mean pull along a mean direction stands for it.
  virtual bool holds_rods() const { return false; }
  /// Returns the pull (N) of a cord, averaged over the last step of `dt` (s).
  virtual double pull(Slot, double /*dt*/) const { return std::numeric_limits<double>::quiet_NaN(); }
  /// Reads the pulls of many cords of this solver into `out`, one after the other.
  virtual void read_pulls(std::span<const Place> cords, double dt, double* out) const {
    for (const Place& cord : cords) *out++ = pull(cord.slot, dt);
  }
  /// Returns what of the last step's impulse (N s) of a rod or tackle was a blow as the step began, since
  /// its length or an anchor changed its speed.
  virtual double blow(Slot) const { return 0; }
  /// Returns the pull of a segment of a tackle.
  virtual double segment_pull(Slot tackle, std::uint32_t /*segment*/, double dt) const {
    return pull(tackle, dt);
  }
  virtual bool is_broken(Slot) const { return false; }
  /// Returns the strain of a rod that reads `strain` by the places of its ends.
  virtual double strain(Slot, double strain) const { return strain; }
  /// Sets the length (m) of a cord, or what is out of a reel, and its rate (m/s) in the next step. All cords
  /// of a step get theirs before begin_piece().
  virtual void set_length(Slot, double /*length*/, double /*rate*/) {}

  // --- Twists, by slots of their own; of solvers that have them (MadeSolver::twists)

  /// Lets the last cross section of a chain be turned to `angle` (rad) at the end of the next step.
  virtual void set_twist(Slot, double /*angle*/) {}
  virtual double twist(Slot) const { return 0; }  ///< rad

  // --- Snapshots

  /// Lists all that steps and programs change, between steps.
  virtual void archive(Archive&) = 0;
  /// Returns whether archive() does so.
  virtual bool has_archive() const { return true; }

  // --- Settings and reports

  /// Returns whether sweeps move rods, so that the stop rule says how much work there is.
  virtual bool sweeps() const { return false; }
  virtual bool set_stop_rule(const StopRule&) { return false; }  ///< true if it is read
  /// Says how many equal substeps steps take from now on, to those that need it beside advance().
  virtual void set_substeps(std::uint32_t) {}
  virtual bool set_weights(Weights) { return false; }  ///< true if they are read
  /// Adds to the report what is laid out here: blocks, rods by method, and what is skipped.
  virtual void describe(WorldInfo&) const = 0;
};

}  // namespace plumb::detail
