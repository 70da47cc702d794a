#pragma once

#include <cstdint>
#include <memory>
#include <vector>

#include "direct/trees/line_segments.hpp"
#include "direct/trees/tree_kind.hpp"
#include "interface/archive.hpp"
#include "interface/changes.hpp"
#include "interface/solver.hpp"

namespace plumb::detail {

/// This solver has a lane group: equal trees side by side, or one tree alone. A long line alone is cut into
/// segments.
///
/// Slots of movable particles number state.x by triples, and ties follow.
template <class T>
class TreeSolver final : public Solver {
 public:
  TreeSolver(std::shared_ptr<TreeKind<T>> kind, std::uint32_t trees);

  /// Puts a tree of the scene into a lane, at rest. Lanes without a tree of their own repeat the last one.
  void fill_lane(std::uint32_t lane, const Scene& scene, MassModel model, const layouts::Tree& tree,
                 const TreeMembers& members);
  /// Gives a lane its bends, in the order of its topology.
  void fill_bends(std::uint32_t lane, const BendTable& table, std::span<const std::uint32_t> bends);
  /// Gives a lane its twist, whose slot is the lane.
  void fill_twist(std::uint32_t lane, const BendTable& table, std::uint32_t twist);
  /// Cuts a long line, and allocates what steps need. Call it once all lanes are filled. Where shapes may
  /// touch, steps allocate now and then, and trees for halved substeps wait until they are needed.
  void finish_layout(bool may_touch = false);
  Slot node_slot(std::uint32_t node, std::uint32_t lane) const;
  Slot tie_slot(std::uint32_t tie, std::uint32_t lane) const;

  /// Brings rods to their lengths by one step too short for loads to act. Returns the number of trees for
  /// which that cannot be solved. They stay as they are.
  std::uint32_t project_positions();
  /// Sets the velocity (m/s) that a particle starts with. project_velocities() takes from all what pulls on
  /// rods.
  void set_velocity(Slot slot, Vec3 velocity);
  void project_velocities();

  std::uint32_t islands(std::uint32_t) const override { return line_ ? 1 : state_.trees; }
  std::uint32_t island_of(Slot slot) const override { return line_ ? 0 : place_of(slot).lane; }
  void begin_piece(std::uint32_t, unsigned part) override;
  double advance(std::uint32_t, double h, std::uint32_t count, unsigned part, Tally& report) override;
  void end_piece(std::uint32_t, double dt, unsigned part) override;
  void begin_step(double dt, Team&) override {
    velocities_known_ = false;
    begin_twists(state_.twists.numbers, dt);
  }
  void end_step(StepReport&) override {
    lengths_changed_ = grabs_changed_ = false;
    finish_twists(state_.twists.numbers);
  }

  ErrorModel error_model() const override;
  double& best_substep(std::uint32_t) override { return best_substep_; }
  std::uint32_t cuts(std::uint32_t, double h) const override { return kind_->stepper.cuts(state_, h); }
  bool anchors_changed(std::uint32_t) const override {
    return anchors_changed_ || lengths_changed_ || grabs_changed_;
  }
  bool starts_anew(std::uint32_t) const override;
  void save(std::uint32_t, Saved which) override;
  void restore(std::uint32_t, Saved which) override;
  void mark(std::uint32_t) override;
  double distance_from_mark(std::uint32_t) const override;
  bool try_calm_step(std::uint32_t, double h, std::uint32_t count, double allowed, unsigned part,
                     Tally& report) override;
  void end_controlled_step(std::uint32_t, double error, double h, double longest, double allowed,
                           unsigned part) override;

  bool is_slower(std::uint32_t, double speed) const override;
  void rest(std::uint32_t) override;
  double size(std::uint32_t) const override;

  Vec3 position(Slot slot) const override;
  Vec3 velocity(Slot slot) const override;
  void add_to_hash(Slot slot, StateHash& hash) const override;
  void read_positions(std::span<const Run> runs, Vec3* out) const override {
    const std::uint32_t end = ties_begin_ + static_cast<std::uint32_t>(state_.tie_x.size() / 3);
    for (const Run& run : runs)
      if (!state_.read_run(state_.x, 0, ties_begin_, run, out) &&
          !state_.read_run(state_.tie_x, ties_begin_, end, run, out))
        run.read_slots(out, [this](Slot slot) { return position(slot); });
  }
  void read_velocities(std::span<const Run> runs, Vec3* out) const override {
    find_velocities();
    for (const Run& run : runs)
      if (!state_.read_run(velocity_, 0, ties_begin_, run, out))
        run.read_slots(out, [this](Slot slot) { return velocity(slot); });
  }
  double read(std::span<const Slot> slots, std::span<Vec3> out) const override;
  void set_force(Slot slot, Vec3 newton) override;
  void set_gravity(Vec3 gravity, Vec3 change) override;
  void set_motion(Slot slot, Vec3 position, Vec3 velocity) override;
  Past past(Slot slot) const override { return {state_.u_step[place_of(slot).lane]}; }
  void go_on(Slot slot, const Past& past) override {
    const Entry at = place_of(slot);
    if (kind_->rules.gradient != Gradient::new_ || !(past.substep > 0)) return;
    state_.displace(at.node, at.lane, past.substep);
    velocities_known_ = false;  // A restored world finds them by displacements.
  }
  void fit(bool is_off) override;
  void set_away(Slot slot, bool away) override;
  bool is_away(std::uint32_t) const override { return away_ || state_.trees == 0; }

  void move_anchor(Slot slot, const AnchorMove& move) override;
  void begin_anchors() override;
  void end_anchors() override;
  void place_anchor(Slot slot, Vec3 target) override;

  /// Rods to parents have the slots of their nodes, and rods to anchors those of ties.
  Slot rod_slot(std::uint32_t node, std::uint32_t lane) const;
  void count_pulls() override;
  double pull(Slot rod, double dt) const override;
  double blow(Slot rod) const override;
  void read_pulls(std::span<const Place> rods, double dt, double* out) const override;
  Vec3 hold(Slot slot, double dt) const override;
  bool holds_rods() const override { return true; }
  bool is_broken(Slot rod) const override;
  void set_length(Slot rod, double length, double rate) override;

  const char* refuses_grab(std::span<const Slot> slots) const override;
  void put_grab(const HeldGrab& grab, std::span<const GrabShare> shares) override;
  void end_grab(std::uint32_t number) override;
  void aim_grab(std::uint32_t number, Vec3 velocity) override;
  void place_grab(std::uint32_t number, Vec3 target) override;
  const HeldGrab* held_grab(std::uint32_t number) const override;

  void set_twist(Slot twist, double angle) override { state_.twists.numbers[twist].target = angle; }
  double twist(Slot twist) const override { return state_.twists.twisted[twist]; }

  /// Velocities are found when they are asked for. What an accuracy saves stands within a step alone.
  void archive(Archive& archive) override {
    auto& [kind, state, line, ties_begin, velocity, velocities_known, anchors_changed, lengths_changed,
           grabs_changed, away, is_calm, calm_steps, saved, mark, best_substep] = *this;
    archive(state, anchors_changed, lengths_changed, grabs_changed, away, is_calm, calm_steps, best_substep);
    if (archive.restores()) velocities_known = false;
  }

  void describe(WorldInfo& info) const override;

 private:
  /// A line in segments is kept as it is cut, and as a whole for what happens rarely.
  struct Line {
    LineSegments segments;
    TreeState<T> whole;
    TreeWorkspace<T> work;
  };
  struct Entry {
    std::uint32_t node, lane;
  };
  void make_laws();
  void take_blow(unsigned part);
  void keep_blows();

  Entry place_of(Slot slot) const;
  bool is_tie(Slot slot) const { return slot >= ties_begin_; }
  double advance_one(double h, unsigned part, Tally& report);
  void find_velocities() const;
  void find_velocities(TreeWorkspace<T>& work) const;
  void keep_velocities(std::uint32_t lane);
  void see_change(const CordLength& before, const CordLength& after) {
    const bool jumps = detail::see_change(before, after, velocities_known_, [this] { find_velocities(); });
    lengths_changed_ = lengths_changed_ || jumps;
  }

  std::shared_ptr<TreeKind<T>> kind_;
  mutable TreeState<T> state_;
  mutable std::unique_ptr<Line> line_;
  std::uint32_t ties_begin_ = 0;  ///< It is the first slot of a tie.
  mutable layouts::AlignedBuffer<T>
      velocity_;  ///< It has 3 numbers per node, in m/s, of the end of the last step if known.
  mutable bool velocities_known_ = false;
  bool anchors_changed_ = false, lengths_changed_ = false, grabs_changed_ = false;
  bool away_ = false;     ///< Another solver moves the line.
  bool is_calm_ = false;  ///< Gradient mid moves it.
  int calm_steps_ = 0;    ///< In so many steps in turn mid would have done.
  // An accuracy needs these:
  std::unique_ptr<TreeState<T>> saved_[2];
  layouts::AlignedBuffer<double> mark_{};
  double best_substep_ = 0;
};

extern template class TreeSolver<float>;
extern template class TreeSolver<double>;

}  // namespace plumb::detail
