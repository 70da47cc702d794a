#pragma once

#include <cstdint>
#include <memory>
#include <optional>

#include "direct/loops/loop_stepper.hpp"
#include "interface/archive.hpp"
#include "interface/changes.hpp"
#include "interface/solver.hpp"
#include "plumb/layouts/memory.hpp"

namespace plumb::detail {

/// All islands with loops share these rules.
struct LoopRules {
  /// Without an accuracy nothing is estimated.
  LoopRules(Gradient of, std::uint32_t order, double air, std::optional<double> share, Isa instructions)
      : gradient(of),
        time_order(order),
        accuracy(share),
        estimates(share && order == 2 && of != Gradient::new_),
        isa(instructions),
        drag(air),
        stepper(of, air, order) {}

  /// Sets the strain that islands solved by their lines may keep.
  void set_stop_rule(const StopRule& rule);

  Gradient gradient;
  std::uint32_t time_order;
  std::optional<double> accuracy;
  bool estimates;  ///< Errors are estimated from accelerations, which islands then keep.
  Isa isa;
  double drag;  ///< It is in 1/s.
  LoopStepper stepper;
};

/// This solver has one island with loops. Slots are its vertices, of which the movable ones come first.
class LoopSolver final : public Solver {
 public:
  LoopSolver(std::shared_ptr<LoopRules> rules, LoopState state);

  /// Brings rods to their lengths by one step too short for loads to act. Returns 1 if that cannot be solved.
  /// The island stays as it is then.
  std::uint32_t project_positions();
  /// Sets the velocity (m/s) that a particle starts with. project_velocities() takes from all what pulls on
  /// rods.
  void set_velocity(Slot slot, Vec3 velocity);
  void project_velocities();

  std::uint32_t islands(std::uint32_t) const override { return 1; }
  void begin_piece(std::uint32_t, unsigned) override;
  void end_piece(std::uint32_t, double dt, unsigned part) override;
  double advance(std::uint32_t, double h, std::uint32_t count, unsigned, Tally& report) override;

  ErrorModel error_model() const override;
  double& best_substep(std::uint32_t) override { return best_substep_; }
  std::uint32_t cuts(std::uint32_t, double h) const override { return rules_->stepper.cuts(state_, h); }
  bool anchors_changed(std::uint32_t) const override {
    return anchors_changed_ || lengths_changed_ || grabs_changed_;
  }
  bool starts_anew(std::uint32_t) const override { return anchors_changed(0) || state_.u_step == 0; }
  void begin_step(double dt, Team&) override { begin_twists(state_.twists, dt); }
  void end_step(StepReport&) override {
    lengths_changed_ = grabs_changed_ = false;
    finish_twists(state_.twists);
  }
  void save(std::uint32_t, Saved which) override;
  void restore(std::uint32_t, Saved which) override;
  void mark(std::uint32_t) override { mark_ = state_.x; }
  double distance_from_mark(std::uint32_t) const override;
  void end_controlled_step(std::uint32_t, double, double, double, double, unsigned) override;

  bool is_slower(std::uint32_t, double speed) const override;
  void rest(std::uint32_t) override;
  double size(std::uint32_t) const override;

  Vec3 position(Slot slot) const override { return reeled_position(state_, slot); }
  Vec3 velocity(Slot slot) const override;
  void read_positions(std::span<const Run> runs, Vec3* out) const override;
  void read_velocities(std::span<const Run> runs, Vec3* out) const override;
  void add_to_hash(Slot slot, StateHash& hash) const override;
  double read(std::span<const Slot> slots, std::span<Vec3> out) const override;
  void set_force(Slot slot, Vec3 newton) override;
  void set_gravity(Vec3 gravity, Vec3 change) override;
  void move_anchor(Slot slot, const AnchorMove& move) override;
  void begin_anchors() override;
  void end_anchors() override;
  void place_anchor(Slot slot, Vec3 target) override;
  void set_motion(Slot slot, Vec3 position, Vec3 velocity) override;
  Past past(Slot) const override { return {state_.u_step}; }
  void go_on(Slot slot, const Past& past) override;
  void fit(bool is_off) override {
    if (is_off) {
      lock({});  // what was straight where rods were their length is not where they are off it
      project_positions();
    }
    project_velocities();
  }
  void set_away(Slot, bool away) override { away_ = away; }
  bool is_away(std::uint32_t) const override { return away_; }

  void count_pulls() override;
  Vec3 hold(Slot slot, double dt) const override;
  bool holds_rods() const override { return true; }
  /// Tackles have the slots after those of rods, and reels those after them.
  double pull(Slot cord, double dt) const override;
  double blow(Slot cord) const override;
  double segment_pull(Slot cord, std::uint32_t segment, double dt) const override;
  bool is_broken(Slot rod) const override;
  double strain(Slot rod, double strain) const override { return reeled_strain(state_, rod, strain); }
  void set_length(Slot cord, double length, double rate) override;

  const char* refuses_grab(std::span<const Slot> slots) const override;
  void put_grab(const HeldGrab& grab, std::span<const GrabShare> shares) override;
  void end_grab(std::uint32_t number) override;
  void aim_grab(std::uint32_t number, Vec3 velocity) override;
  void place_grab(std::uint32_t number, Vec3 target) override;
  const HeldGrab* held_grab(std::uint32_t number) const override;

  void set_twist(Slot twist, double angle) override { state_.twists[twist].target = angle; }
  double twist(Slot twist) const override { return state_.twisted[twist]; }

  /// Velocities are found when they are asked for. What an accuracy saves stands within a step alone.
  void archive(Archive& archive) override {
    auto& [rules, state, work, velocity, velocity_known, anchors_changed, lengths_changed, grabs_changed,
           away, locks_known, blows, saved, mark, best_substep] = *this;
    archive(state, anchors_changed, lengths_changed, grabs_changed, away, locks_known, blows, best_substep);
    work.archive(archive, state);
    if (archive.restores()) velocity_known = false;
  }

  bool set_stop_rule(const StopRule& rule) override;
  void describe(WorldInfo& info) const override;

 private:
  Slot first_reel() const {
    return static_cast<Slot>(state_.topology->rods.size() + state_.topology->tackles.size());
  }
  bool is_reel(Slot cord) const { return cord >= first_reel(); }
  bool is_tackle(Slot cord) const { return cord >= state_.topology->rods.size(); }
  LoopTackleMotion& tackle(Slot cord) const { return state_.tackles[cord - state_.topology->rods.size()]; }
  void keep_velocities();
  void see_change(const CordLength& before, const CordLength& after) {
    const bool jumps = detail::see_change(before, after, velocity_known_, [this] { find_velocities(); });
    lengths_changed_ = lengths_changed_ || jumps;
  }
  void grabs_change();
  void find_velocities() const;
  void take_blow();
  void keep_blows();
  bool do_anchors_rest() const;
  void lock(Locks locks);

  std::shared_ptr<LoopRules> rules_;
  mutable LoopState state_;
  mutable LoopWorkspace work_;
  mutable Array<double>
      velocity_;  ///< It has 3 numbers per node, in m/s, of the end of the last step if known.
  mutable bool velocity_known_ = false;
  bool anchors_changed_ = false, lengths_changed_ = false, grabs_changed_ = false, away_ = false;
  bool locks_known_ = false;
  Array<double> blows_;  ///< Of rods, then tackles, in N s, see blow(). It is empty until it is needed.
  // An accuracy needs these:
  LoopMotion saved_[2]{};
  Array<double> mark_{};
  double best_substep_ = 0;
};

}  // namespace plumb::detail
