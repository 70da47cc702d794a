#pragma once

#include <cstdint>
#include <memory>

#include "interface/island_sets.hpp"
#include "interface/made_solver.hpp"
#include "interface/solver.hpp"
#include "plumb/layouts/memory.hpp"
#include "relax/block.hpp"
#include "relax/grabs/block_grabs.hpp"
#include "relax/relax.hpp"
#include "time/verlet.hpp"

namespace plumb::detail {

/// All blocks of a scene share these.
struct RelaxRules {
  Settings settings;  ///< Order, weights and the stop rule may change between steps.
  Verlet verlet;
  Vec3 gravity;  ///< It is in m/s².
  Constants constants;
  Array<Vec3> initial_velocities;  ///< They are in m/s, per particle.
  std::uint32_t relaxed_rods = 0;  ///< Rods of all blocks share a budget.
  std::uint32_t shared_rods = 0;   ///< The whole team shares a block with at least so many.
};

/// A block has islands that relaxation moves by sweeps over its rods. Slots are those of its packing.
///
/// A piece is a position of lanes, which shares nothing with the others, or else the whole block. Under the
/// control of an accuracy it is always the whole block.
template <class T>
class RelaxSolver final : public Solver {
 public:
  RelaxSolver(std::shared_ptr<RelaxRules> rules, const Scene& scene, layouts::Packing packing);

  std::uint32_t pieces() const override { return pieces_; }
  std::uint32_t islands(std::uint32_t piece) const override { return islands_[piece]; }
  std::uint32_t island_of(Slot slot) const override { return block_.packing().slot_island[slot]; }
  std::uint32_t piece_of(Slot slot) const override { return pieces_ > 1 ? block_.position_of(slot) : 0; }

  void begin_step(double dt, Team& team) override;
  void begin_piece(std::uint32_t piece, unsigned) override { begin_pulls(piece); }
  double advance(std::uint32_t piece, double h, std::uint32_t count, unsigned part, Tally& report) override;
  bool wants_team() const override;
  void advance_with_team(double h, std::uint32_t count, Team& team, StepReport& report) override;
  void end_step(StepReport&) override;

  ErrorModel error_model() const override;
  double& best_substep(std::uint32_t) override { return best_substep_; }
  void save(std::uint32_t, Saved which) override;
  void restore(std::uint32_t, Saved which) override;
  void mark(std::uint32_t) override;
  double distance_from_mark(std::uint32_t) const override;

  bool is_slower(std::uint32_t piece, double speed) const override;
  void rest(std::uint32_t piece) override;
  void wake(std::uint32_t piece) override;
  double size(std::uint32_t) const override { return size_; }

  Vec3 position(Slot slot) const override { return block_.read(block_.x(), slot); }
  Vec3 velocity(Slot slot) const override;
  void add_to_hash(Slot slot, StateHash& hash) const override;
  std::uint32_t address(Slot slot) const override { return block_.packing().slot_offset[slot]; }
  void read_positions(std::span<const Run> runs, Vec3* out) const override {
    for (const Run& run : runs) block_.read_run(block_.x(), run, out);
  }
  void read_velocities(std::span<const Run> runs, Vec3* out) const override {
    if (!has_moved_) return Solver::read_velocities(runs, out);
    const auto last = block_.reader(block_.displacement(0)), before = block_.reader(block_.displacement(1));
    const auto read = [&, verlet = rules_->verlet, h = h_](std::uint32_t at) {
      return verlet.velocity({last(at), before(at)}, h);
    };
    for (const Run& run : runs) run.read_addresses(out, read);
  }
  double read(std::span<const Slot> slots, std::span<Vec3> out) const override;
  void set_force(Slot slot, Vec3 newton) override;
  void set_gravity(Vec3 gravity, Vec3 change) override;
  void move_anchor(Slot slot, const AnchorMove& move) override { anchors_.push_back({slot, move}); }
  void end_anchors() override { anchors_.clear(); }
  void place_anchor(Slot slot, Vec3 target) override { block_.write(block_.x(), slot, target); }
  void set_motion(Slot slot, Vec3 position, Vec3 velocity) override;
  /// Rods that sweeps left off their lengths do not start there.
  void go_on(Slot, const Past& past) override {
    starts_off_length_ = false;
    leftovers_.go_on(past.leftovers);
  }
  Past past(Slot) const override { return {.leftovers = leftovers_}; }
  void remove(Slot slot) override {
    block_.freeze_island(slot);
    --islands_[piece_of(slot)];
  }
  void set_away(Slot slot, bool away) override;
  bool is_away(std::uint32_t piece) const override { return away_[piece] == islands_[piece]; }

  const char* refuses_grab(std::span<const Slot> slots) const override;
  void put_grab(const HeldGrab& grab, std::span<const GrabShare> shares) override;
  void end_grab(std::uint32_t number) override;
  void aim_grab(std::uint32_t number, Vec3 velocity) override;
  void place_grab(std::uint32_t number, Vec3 target) override;
  const HeldGrab* held_grab(std::uint32_t number) const override;

  void count_pulls() override;
  double pull(Slot lane, double dt) const override { return block_.pulls()[lane] / dt; }
  bool is_broken(Slot lane) const override { return block_.is_broken(lane); }
  void set_length(Slot lane, double length, double rate) override;

  /// Initial velocities are those of the scene until a program hands over others. What an accuracy saves
  /// stands within a step alone, as do paths of anchors.
  void archive(Archive& archive) override {
    auto& [rules, kernels, block, pieces, islands, away, slots_of, rests, size, h, last_h, parts, has_moved,
           kicks_stale, starts_off_length, lengths_jump, elapsed, leftovers, forces, grabs, anchors, saved,
           mark, best_substep] = *this;
    if (block.archive_rods(archive)) weigh();
    archive(block, islands, away, rests, h, last_h, has_moved, kicks_stale, starts_off_length, lengths_jump,
            leftovers.time, leftovers.last, forces, grabs, best_substep);
    if (archive.restores() && h > 0) weigh_grabs(h);
    if (has_moved) return;
    for (const std::uint32_t particle : block.packing().slot_vertex)
      archive(rules->initial_velocities[particle]);
  }

  bool sweeps() const override { return true; }
  bool set_stop_rule(const StopRule& rule) override;
  void set_substeps(std::uint32_t count) override { rules_->settings.substeps = count; }
  bool set_weights(Weights weights) override;
  void describe(WorldInfo& info) const override;

 private:
  struct MovingAnchor {
    Slot slot;
    AnchorMove move;
  };
  /// An accuracy takes this back.
  struct Motion {
    layouts::AlignedBuffer<T> x, last, before, half_kick;
    Array<double> pulls;
    typename Block<T>::SavedRods rods;
    double h = 0, elapsed = 0;
    bool has_moved = false;
    Array<BlockGrab> grabs{};
  };

  bool is_controlled() const { return rules_->settings.accuracy.has_value(); }
  bool is_movable(std::uint32_t particle) const { return rules_->constants.inverse_mass[particle] > 0; }
  std::uint32_t particle_of(Slot slot) const { return block_.packing().slot_vertex[slot]; }
  double inverse_mass(Slot slot) const;
  Vec3 acceleration(Slot slot) const;
  Vec3 acceleration(Slot slot, Vec3 before, double h) const;
  typename Block<T>::Weighing weighing() const;
  void weigh();
  void weigh_grabs(double h);
  using Displacements = Verlet::Displacements;
  void write_displacements(Slot slot, const Displacements& now);
  /// Keeps the velocity as Verlet::change_acceleration() does.
  void change_acceleration(Slot slot, Vec3 change);
  template <class Change>
  void keep_velocity(Slot slot, Change&& change);
  template <class Change>
  void change_grabs(Slot slot, Change&& change);
  RelaxSettings<T> settings_for(double rods, double share);
  /// Returns the factors of rods that give, in a substep of h after one of `last`, or after a velocity (0).
  simd::LawTerms<T> law_terms(double last) const;
  /// Returns what makes impulses of moves in such a substep, in 1/s.
  double pull_of_moves(double last) const;
  void begin_pulls(std::uint32_t piece);
  void take_substeps_of(double h);
  void start_displacements(double h);
  void change_step(double h);
  void write_kicks();
  /// Calls f(slot, particle) for every slot but those of frozen islands and of pieces that rest.
  template <class F>
  void for_slots(F&& f);

  std::shared_ptr<RelaxRules> rules_;
  const simd::Kernels<T>& kernels_;
  Block<T> block_;
  std::uint32_t pieces_ = 1;
  Array<std::uint32_t> islands_, away_;    ///< They count islands per piece, and those moved elsewhere.
  Array<std::pair<Slot, Slot>> slots_of_;  ///< A range holds the slots of each piece.
  Array<std::uint8_t> rests_;              ///< A piece that rests has 1, and no displacements.
  double size_ = 1;                        ///< It is the RMS length of a rod, in m.
  double h_ = 0;                           ///< The last substep took it, in s.
  double last_h_ = 0;                      ///< The one before took it; 0 before the first.
  unsigned parts_ = 1;                     ///< The team has so many in this step.
  bool has_moved_ = false, kicks_stale_ = true, starts_off_length_ = false;
  bool lengths_jump_ = false;  ///< some rate has changed since the last step began
  double elapsed_ = 0;         ///< s, of this step, if an accuracy is set
  Leftovers leftovers_;        ///< of sweeps before the next substep
  Array<Vec3> forces_;         ///< They are in N, per slot; it is empty until one is set.
  Array<BlockGrab> grabs_;
  Array<MovingAnchor> anchors_;
  // An accuracy needs these:
  Motion saved_[2];
  layouts::AlignedBuffer<T> mark_{};
  double best_substep_ = 0;
};

extern template class RelaxSolver<float>;
extern template class RelaxSolver<double>;

/// Makes the blocks of islands that relaxation moves. Velocities are projected so that none pulls on a rod.
/// Throws InputError on numbers that the precision is too coarse for.
Array<MadeSolver> make_relax_solvers(const Scene& scene, const IslandSets& sets, const Settings& settings,
                                     StartReport& report);

}  // namespace plumb::detail
