#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "plumb/export.hpp"
#include "plumb/measures.hpp"
#include "plumb/scene.hpp"
#include "plumb/settings.hpp"

namespace plumb {

/// What ended the sweeps. When blocks or substeps differ, the latest in this list is reported.
enum class StoppedBy : std::uint8_t { nothing, tolerance, sweeps, budget };
PLUMB_API std::string_view to_string(StoppedBy);

/// What one step did and what it skipped. Counts add up over substeps and blocks (sets of rods solved
/// together).
struct StepReport {
  std::uint64_t substeps = 0;
  std::uint64_t block_sweeps = 0;     ///< sweeps over a block, summed over blocks and substeps
  std::uint64_t rod_projections = 0;  ///< rods projected, without padding
  StoppedBy stopped_by = StoppedBy::nothing;
  /// Blocks that were within tolerance after prediction and were not swept (times substeps).
  std::uint64_t skipped_within_tolerance = 0;
  /// Substeps of a block in which gradient mid did not converge and velocity was taken from the step itself.
  std::uint64_t mid_guarded = 0;
  /// Islands that went non-finite in this step. Each was put back to its last finite state and stands still.
  std::uint32_t frozen_islands = 0;

  // Of islands solved directly; of what was done again for accuracy only `newton` counts, and that it was:
  std::uint64_t direct_substeps = 0;  ///< substeps that islands took, those after halvings included
  std::uint64_t newton = 0;           ///< Newton steps, summed over islands
  std::uint64_t halvings = 0;         ///< times an island's substep did not converge and was cut in two
  std::uint64_t fallbacks = 0;        ///< substeps taken with gradient new because nothing else converged
  std::uint64_t repeated_steps = 0;   ///< steps of islands done again, finer, to be accurate enough
  /// Substeps that not even that solved: the tree stayed where it was, an island with loops took its rods as
  /// slightly elastic. Of multipliers: projections that did not converge.
  std::uint64_t unsolved = 0;
  /// Steps taken, of islands or by adaptive_implicit_euler, although shorter ones would not, or could not, be
  /// accurate enough.
  std::uint64_t inaccurate_steps = 0;

  // Of method springs, at the end of a step; of several steps or islands the worst:
  double largest_gap = 0;  ///< m between ends of rigid rods that should meet (thesis figure 4.5)
  double rms_gap = 0;      ///< m, over the joints of an island

  // Of scenes with limbs that touch:
  std::uint64_t contacts = 0;        ///< points at which something pushed, at most in one group's substep
  std::uint64_t guarded_energy = 0;  ///< substeps that would have gained energy, and were not let
  std::uint32_t awake_islands = 0;   ///< at the end of the step
  std::uint32_t fell_asleep = 0;     ///< islands, in this step

  PLUMB_API StepReport& operator+=(const StepReport& other);
};

/// How a scene was laid out, for `plumb info` and reports.
struct BlockInfo {
  std::string shape;   ///< chain, grid, lanes (equal islands side by side), graph or linkage
  std::string layout;  ///< aos, soa or aosoa
  std::uint32_t islands = 0;
  std::uint32_t particles = 0;
  std::uint32_t rods = 0;
  std::uint32_t colors = 0;
  std::size_t bytes = 0;            ///< state and rods, with padding
  double bytes_per_projection = 0;  ///< read and written by one rod's projection, before caching
  double uniform_fraction = 0;      ///< share of rods that need no per-rod length and weights
};
struct WorldInfo {
  std::uint32_t particles = 0;
  std::uint32_t rods = 0;
  std::uint32_t islands = 0;
  Isa isa = Isa::scalar;
  unsigned threads = 1;
  bool parallel = false;           ///< false: one thread, or the scene is below the size where threads win
  std::uint32_t relaxed_rods = 0;  ///< rods moved by method relax
  std::uint32_t direct_rods = 0;   ///< rods moved by method direct
  Gradient direct_gradient = Gradient::mid;  ///< the one that method direct takes
  bool changes_gradient = false;             ///< some trees take mid while they move calmly
  std::uint32_t direct_time_order = 2;  ///< and its time order; method automatic: of the first islands alike
  std::uint32_t linkages = 0;           ///< kinds of islands in a scene with limbs, joints or contact; else 0
  std::uint64_t skipped_per_rod_weights = 0;  ///< rods in uniform ranges: no weights or lengths are read
  bool skipped_drag = true;                   ///< no drag: no factor on displacements
  double projected_velocity =
      0;  ///< m/s; largest change made to initial velocities so that none pulls on a rod
  /// m; largest change made to positions so that rods start at their lengths, of islands that method direct
  /// moves and that have no limbs.
  double projected_position = 0;
  std::uint32_t unprojected_islands = 0;  ///< of those, where that could not be solved: they stay as they are
  std::vector<BlockInfo> blocks;          ///< equal blocks are listed once, with their sums
};

class World;

/// Positions (m) or velocities (m/s) of a World in the scene's particle order, read in place: nothing is
/// copied, and what is read is always the present state. Valid while the world lives and is not moved.
class StateView {
 public:
  std::size_t size() const;
  Vec3 operator[](std::uint32_t particle) const;  ///< throws InputError on an unknown particle

 private:
  friend class World;
  enum class Field : std::uint8_t { position, velocity };
  StateView(const World& world, Field field) : world_(&world), field_(field) {}

  const World* world_;
  Field field_;
};

/// A scene compiled for stepping.
///
/// Methods relax and direct: state per particle is the position and the displacement of the last substep,
/// never two positions: a float position minus a float position loses g·h² below one unit in the last place.
///
/// Not thread-safe: one thread at a time. The world keeps no reference to the scene.
class PLUMB_API World {
 public:
  /// Throws InputError (see validate(); also if numbers do not fit the precision or 32-bit places, or if the
  /// method cannot move the scene), and leaves nothing behind.
  explicit World(const Scene& scene, const Settings& settings = {});
  ~World();
  World(World&&) noexcept;
  World& operator=(World&&) noexcept;

  /// Advances by dt seconds in Settings::substeps equal substeps; with an accuracy in as many as it takes.
  /// Throws InputError if dt is not positive and finite. Methods relax, direct and auto allocate nothing
  /// after the first call, but to freeze an island, when an island with loops solved directly has to fall
  /// back for the first time (a net with any gradient; others with gradient old and lumped masses), and for
  /// the first anchor that moves; where limbs may touch, until no more of them touch at once than before.
  StepReport step(double dt);

  /// Changes that take effect at the next step. Layout, precision, instruction set and threads stay. Throws
  /// InputError on a rule that makes no sense.
  void set_stop_rule(const StopRule& rule);
  void set_weights(Weights weights);

  /// A constant force in N on a movable particle, kept until changed. Throws InputError on an unknown or
  /// fixed particle or a force that is not finite.
  void set_force(std::uint32_t particle, Vec3 force);
  /// Moves a fixed particle to `target` (m) during the next step, along a straight line, a substep at a time.
  /// Throws InputError on an unknown or movable particle or a target that is not finite.
  void move_anchor(std::uint32_t particle, Vec3 target);

  std::uint32_t particle_count() const;
  std::uint32_t rod_count() const;
  double time() const;  ///< s

  /// State in the scene's particle order, one by one, as views, or copied into `out`, which must have
  /// particle_count() elements. Throws InputError on an unknown particle or an `out` of another size.
  /// Velocities are those at the end of the step, as accurate as the positions,
  /// second order for relax.
  StateView positions() const { return {*this, StateView::Field::position}; }
  StateView velocities() const { return {*this, StateView::Field::velocity}; }
  void copy_positions(std::span<Vec3> out) const;
  void copy_velocities(std::span<Vec3> out) const;
  Vec3 position(std::uint32_t particle) const;
  Vec3 velocity(std::uint32_t particle) const;

  /// Positions and displacements (velocities, for springs, multipliers and featherstone) of all particles, in
  /// the scene's order, as a 64-bit FNV-1a hash: equal for every instruction set and number of threads.
  std::uint64_t state_hash() const;

  const WorldInfo& info() const;

 private:
  struct PLUMB_HIDDEN Impl;
  std::unique_ptr<Impl> impl_;
};

inline std::size_t StateView::size() const {
  return world_->particle_count();
}
inline Vec3 StateView::operator[](std::uint32_t particle) const {
  return field_ == Field::position ? world_->position(particle) : world_->velocity(particle);
}

}  // namespace plumb
