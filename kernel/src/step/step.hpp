#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <span>
#include <string_view>
#include <utility>

#include "plumb/layouts/memory.hpp"
#include "step/breaks/breaks.hpp"
#include "step/breaks/log.hpp"
#include "step/breaks/numbers.hpp"
#include "step/compile/compiled.hpp"
#include "step/inputs/anchors.hpp"
#include "step/inputs/cords.hpp"
#include "step/inputs/grabs.hpp"
#include "step/inputs/lengths.hpp"
#include "step/inputs/loads.hpp"
#include "step/reactions.hpp"
#include "step/sleep.hpp"
#include "step/state/events.hpp"
#include "step/state/standing.hpp"
#include "threads/sharing.hpp"
#include "threads/workers.hpp"
#include "time/advance.hpp"
#include "time/budget.hpp"

namespace plumb::detail {

/// Holds a compiled scene and steps it.
class Step : public InMemory {
 public:
  /// Compiles the scene, which is valid already, as are the settings, and which nobody changes. Throws
  /// InputError if the settings' method cannot move it.
  Step(std::shared_ptr<const Scene> shared, const Settings& settings);

  /// Asks the load for its forces in a step of dt (s) from `time` (s) on. What it throws is before the step.
  void ask_load(double time, double dt);
  /// Advances by dt (s) through the stages that step.cpp lists.
  StepReport run(double dt);
  /// Throws what the executor threw in the last step. That step was done all the same.
  void rethrow_executor_failure() { workers_.team().rethrow_failure(); }

  const Settings& settings() const { return settings_; }  ///< of now
  /// Returns this world under other settings, which are valid, as it is now (change/changed.cpp). Throws
  /// InputError if they cannot move it, or if some of its state has no place there.
  /// make(scene) makes one under these as it began.
  using Make = std::function<std::unique_ptr<Step>(std::shared_ptr<const Scene>)>;
  std::unique_ptr<Step> changed(const Settings& settings, const Make& make) const;
  void set_stop_rule(const StopRule& rule);
  void set_weights(Weights weights);
  std::uint32_t substeps() const { return settings_.substeps; }  ///< those that are asked for
  void set_substeps(std::uint32_t substeps) {
    settings_.substeps = substeps;
    is_described_ = false;
  }
  std::optional<double> accuracy() const { return settings_.accuracy; }
  void set_accuracy(double accuracy);
  void set_zones(Zones zones) { zones_ = std::move(zones); }
  /// Gives every step so much wall time (us), or as much as it takes.
  void set_budget(std::optional<double> us) { budget_.set(us); }
  void set_force(std::uint32_t particle, Vec3 force);
  void set_load(Load load) { loads_.set(std::move(load)); }
  void move_anchor(std::uint32_t particle, Vec3 target);
  /// Grabs a place of the scene's particles. Throws InputError if its solver cannot.
  std::uint32_t grab(const Grab& grab);
  void release(std::uint32_t number);
  void move_grab(std::uint32_t number, Vec3 target) { grabs_.set_target(number, target); }
  const Grabs& grabs() const { return grabs_; }
  void move_platform(std::uint32_t number, const Pose& target) {
    if (compiled_.contact) compiled_.contact->move_platform(number, target);
  }
  /// Throws InputError if no solver can change the length of this cord.
  void set_length(std::uint32_t cord, double target);

  /// Changes a spring, a torsion or an angle. Throws InputError on an unknown one, and on a change that needs
  /// another matrix.
  template <class Item>
  void set_law(std::uint32_t number, const Item& item) {
    if (!compiled_.contact) refuse_unknown(number, item);
    compiled_.contact->set_law(number, item);
  }
  double torsion_angle(std::uint32_t number) const {
    if (!compiled_.contact) refuse_unknown(number, Torsion{});
    return compiled_.contact->torsion_angle(number);
  }

  std::uint32_t reel_cord(std::uint32_t reel) const { return first_line + reel; }
  std::uint32_t tackle_cord(std::uint32_t tackle) const {
    return first_line + static_cast<std::uint32_t>(first_scene().reels.size()) + tackle;
  }
  const Tackle& tackle(std::uint32_t number) const { return breaks_.scene_now().tackles[number]; }

  double length(std::uint32_t cord) const { return lengths_.length(cord); }
  /// Returns NaN where no solver knows the pull (N) of a cord, or a tackle's segment, in the last step.
  double pull(std::uint32_t cord, std::uint32_t segment = 0) const;
  double power(std::uint32_t cord) const;
  /// Copies the pulls of the first cords, which are faster to read together.
  void copy_pulls(std::span<double> out);
  /// Returns the force (N) that held a fixed particle in the last step, or NaN where a pull is.
  Vec3 reaction(std::uint32_t particle) const;
  bool is_broken(std::uint32_t rod) const;
  /// Returns whether an item of a kind is joined in the next step, and nowhere before.
  bool waits(std::size_t kind, std::uint32_t number) const;
  template <class Item>
  bool waits(std::uint32_t number) const {
    return waits(kind_of<Item>(), number);
  }
  const Breaks& breaks() const { return breaks_; }
  /// Returns whether a rod is to be cut in the next step.
  bool is_ordered(std::uint32_t rod) const {
    return std::find(edits_.cut.begin(), edits_.cut.end(), rod) != edits_.cut.end();
  }

  // --- Edits, of which those that make islands anew wait for the next step (breaks/orders.cpp)

  /// Takes a rod out. Throws InputError if its island cannot be made anew.
  void cut(std::uint32_t rod);
  /// Takes out a joint or a spring, which messages call `what`. Throws InputError likewise.
  void cut(std::size_t kind, const char* what, std::uint32_t number);
  /// Fixes a particle, or frees it. Throws InputError likewise, and if it has no mass to be freed with.
  void fix(std::uint32_t particle, bool is_fixed);
  void set_mass(std::uint32_t particle, double mass);
  /// Joins particles by a rod whose length is known, a joint or a spring, which has them in all slots.
  /// `alone` is that by itself. Returns its number. Throws InputError where it does not fit or an island
  /// cannot be made anew, and if the settings cannot move it.
  template <class Item>
  std::uint32_t join(const Item& item, const Scene& alone);
  /// Lets islands that do not lie well be made anew side by side.
  void pack();
  void set_gravity(Vec3 gravity) { next_gravity_ = gravity; }
  Vec3 gravity() const { return gravity_; }            ///< m/s^2, of the last step
  Vec3 next_gravity() const { return next_gravity_; }  ///< m/s^2, of the next one
  /// Puts particles elsewhere at once. Throws InputError if rods do not fit then.
  void teleport(std::span<const std::uint32_t> particles, std::span<const Vec3> positions,
                std::span<const Vec3> velocities);
  /// Returns whether a particle is fixed, or will be from the next step on.
  bool will_be_fixed(std::uint32_t particle) const { return anchors_.will_be_fixed(particle); }
  std::span<const std::uint8_t> will_be_fixed() const { return anchors_.will_be_fixed(); }
  bool is_fixed(std::uint32_t particle) const { return anchors_.is_fixed(particle); }

  // --- What is added and removed at once (breaks/additions.cpp)

  /// Adds islands. The scene is valid. Throws InputError if the settings cannot move them. Returns the first
  /// number of each kind.
  ByKind<std::uint32_t> add(const Scene& scene);
  /// Removes the island of a movable particle, or a fixed one from which nothing hangs. Throws InputError
  /// where an island cannot be removed. Returns the particles that are gone.
  Array<std::uint32_t> remove(std::uint32_t particle);
  /// Does what the first edit would do of the whole scene, and lets there be so many more numbers, which
  /// edits take before new ones.
  void make_room(const ByKind<std::uint32_t>& more);
  const Population& population() const { return population_; }
  double drag() const { return first_scene().drag; }
  double joint_drag() const { return first_scene().joint_drag; }

  bool has_contact() const { return compiled_.contact != nullptr; }
  /// Returns what knows the forces of joints, springs and contacts. There must be one of these.
  const ContactSolver& contact() const { return *compiled_.contact; }
  bool has_shape(ShapeId shape) const { return !compiled_.contact || compiled_.contact->has_shape(shape); }
  /// Returns the particle around which alone a capsule is, if there is one: where the scene says so, and
  /// where a rod that it was along is out.
  std::optional<std::uint32_t> middle_of(std::uint32_t capsule) const {
    return compiled_.contact ? compiled_.contact->middle_of(capsule) : std::nullopt;
  }
  /// Returns the force (N) of the last step on ground that the scene has. Without shapes nothing touches it.
  Vec3 force_on_ground(ShapeId ground) const {
    return compiled_.contact ? compiled_.contact->force_on_ground(ground) : Vec3{};
  }
  std::span<const Contact> contacts() const {
    return compiled_.contact ? compiled_.contact->contacts() : std::span<const Contact>{};
  }

  double twist(std::uint32_t twist) const;
  void set_twist(std::uint32_t twist, double angle);

  Array<Problem> problems(double most_strain) const;
  std::span<const Event> events() const { return events_.all(); }

  const Scene& first_scene() const { return *origin_.scene; }  ///< with which it began
  /// Returns the scene with what was added since, of which some may have been removed.
  const Scene& scene() const { return breaks_.scene_now(); }
  Standing standing(std::uint32_t particle) const;
  Vec3 position(std::uint32_t particle) const;
  Vec3 velocity(std::uint32_t particle) const;
  void copy_positions(std::span<Vec3> out) const;
  void copy_velocities(std::span<Vec3> out) const;
  std::uint64_t state_hash() const;

  /// Returns whether all solvers have archives (Solver::has_archive()). Those that are made later do, too.
  bool has_archive() const { return has_archive_; }
  /// Lists what became of islands: what fell apart, was edited, added or removed so far.
  void archive_past(Archive& archive);
  /// Reads that of a snapshot. Returns this scene with that past, or null if this world has it.
  std::unique_ptr<Step> restored_past(Archive& archive);
  /// Lists all that steps and programs change, of a world whose past is the same.
  void archive(Archive& archive);
  const WorldInfo& info(std::size_t memory) {
    if (!is_described_) describe();
    compiled_.info.memory = memory;
    return compiled_.info;
  }

 private:
  /// This is a line of the step: what it does, and whether this scene needs it.
  struct Stage {
    void (Step::*run)(StepReport& report);
    bool (Step::*is_needed)() const;
    std::string_view name;
  };
  static const Stage all_stages[];
  bool always() const { return true; }
  bool has_events() const { return settings_.events; }

  void split(StepReport& report);
  void wake(StepReport& report);
  void collide(StepReport& report);
  void solve(StepReport& report);
  void sleep(StepReport& report);
  void measure(StepReport& report);
  void list_events(StepReport& report);
  void list_troubles(bool also_lasting, Array<Troubles>& out) const;
  std::size_t troubles_at(std::uint32_t particle) const;
  void reserve();
  void describe();
  void archive_rules(Archive& archive);
  void begin_budget();
  void relive(Array<Split> splits, Population& population, std::uint32_t seats, std::uint32_t islands);
  std::uint32_t contact_islands() const { return compiled_.contact ? compiled_.contact->island_count() : 0; }
  void relive_anew(const Step& from);
  void require_same_pieces(const Step& from) const;
  void redo(const Split& split, const Step& from);
  void copy_state(const Step& from);
  void carry(const Step& from);
  void carry_inputs(const Step& from);
  void carry_lengths(const Step& from);
  void carry_motion(const Step& from);
  void carry_anchors();
  void carry_grabs(const Step& from);
  void carry_sleep(const Step& from);
  void fit();
  Array<std::uint32_t> broken_now() const;
  void order_cut(std::uint32_t rod);
  void cut_broken();
  void split(Fallen fallen, Split& now);
  void repeat(Split split_then);
  void exchange(Fallen& fallen, Split& now, Compiled made);
  const Place* contact_place(std::uint32_t particle) const;
  Fallen take_out(const Split& now);
  void take_along(const Split& now);
  void list_side_by_side();
  void list_loose();
  std::uint32_t put_parts(std::span<const ContactSolver::Made> made);
  void put_places(const Fallen& fallen, const Compiled& made, std::span<const std::uint32_t> numbers);
  Array<std::uint32_t> remove_places(std::span<const std::uint32_t> leaving,
                                     std::span<const std::uint32_t> touched, std::uint32_t& islands);
  void free_seats(std::span<const std::uint32_t> solvers);
  void seat(Array<std::unique_ptr<Solver>> made, Array<std::uint32_t>& seats, bool are_loose);
  std::uint32_t relaxed_rods_of(const Solver& solver) const;
  Settings settings_of_now() const;
  Scene scene_of(const Addition& of) const;
  Compiled compile_addition(const Scene& scene) const;
  void put(Split& now, Compiled made);
  void list_arrivals(const Addition& of);
  void grow_tables();
  void measure_size(const Scene& scene);
  void relate_errors();
  Names take_away(std::uint32_t particle);
  Names list_island(std::uint32_t particle) const;
  void tell_of(const Names& names);
  void put_in_contact(Split& now, Names names);
  bool holds_ground(std::uint32_t anchor) const {
    return compiled_.contact && compiled_.contact->holds_ground(anchor);
  }
  PartEdits list_part_edits(const Edits& edits, Array<std::uint32_t>& touched) const;
  Array<std::uint32_t> meeting(const Edits& edits) const;
  Array<ContactSolver::Made> make_parts(const Fallen& fallen) const;
  Array<ContactSolver::Made> make_numbered_parts(Fallen& fallen, Split& now);
  void go_on_in_contact(const Fallen& fallen, std::span<const ContactSolver::Made> made);
  bool holds_linkage(std::uint32_t particle) const;
  Array<std::uint32_t> bent_with(std::uint32_t particle) const;
  void forget(const Names& gone);
  void drop_edits(const Names& of);
  void order(const Edits& edits, bool is_ordered);
  void refix(const Edits& edits);
  bool joins_by_mass(std::uint32_t rod) const;
  void take_back(Names numbers);
  template <class Item>
  void require_joinable(const Item& item, const Scene& alone) const;
  void require_place_for(const Rod& rod, const Scene& alone) const;
  void require_place_for(const Pin& pin, const Scene& alone) const;
  void require_place_for(const Alignment& alignment, const Scene& alone) const;
  void put_joined(const Edits& edits);
  void set_state(Fallen& fallen, const Split& now) const;
  Log::Group group_of(const Fallen& fallen, const Split& now);
  void set_held_state(Fallen& fallen, const Split& now) const;
  void settle(Fallen fallen, Split& now) const;
  void change_gravity();
  void apply_gravity(Vec3 gravity);
  template <class At>
  void require_fit(std::span<const std::uint32_t> particles, At&& at) const;
  struct Motion;
  template <class At>
  void keep_lengths(Array<Motion>& motions, At&& at) const;
  template <class At>
  void put_anchors(std::span<const std::uint32_t> particles, At&& at);
  void require_fit_of_fixed(std::uint32_t particle) const;
  void require_kept_between_fixed(std::uint32_t rod, std::uint32_t particle) const;
  double misfit_now(std::uint32_t rod, double distance) const;
  Array<std::uint32_t> bodies_at(std::uint32_t particle) const;
  void require_mass_without(const Names& going) const;
  void require_mass(std::uint32_t particle, const Names& without = {}) const;
  void require_refixable(std::uint32_t particle, bool is_fixed) const;
  void require_editable(const char* what, std::uint32_t number, std::uint32_t particle) const;
  bool meets_as_no_winch(std::uint32_t cord, const Array<std::uint32_t>& ends) const;
  bool is_of_body(std::uint32_t rod) const;
  bool meets_in_contact(const Edits& edits, std::span<const std::uint32_t> ends) const;
  void require_simple_meeting(const std::string& what, const Edits& edits) const;
  void hand_over(const Fallen& fallen, const Split& now, std::span<const Solver::Past> pasts);
  void fit_freed(const Fallen& fallen, const Split& now);
  /// Calls f(solver) for all solvers that move something.
  template <class F>
  void for_solvers(F&& f) const {
    for (std::size_t s = 0; s < seats_.size(); ++s)
      if (seats_[s] != Seat::free) f(*compiled_.solvers[s]);
  }
  void tell(Task& task, const StepReport& before, const StepReport& after);
  void advance_with_team(std::uint32_t number, Solver& solver, Team& team);
  void advance(Solver& solver, std::uint32_t piece, unsigned part);
  void advance(Task& task, unsigned part);
  bool uses_threads() const;
  void put_force(std::uint32_t particle, Vec3 force);
  void begin_grabs();
  void end_grabs();
  void wake_grabbed(std::uint32_t number);
  Array<std::uint32_t> take_grabs(std::span<const std::uint32_t> particles);
  void put_grabs(std::span<const std::uint32_t> numbers);
  void begin_lengths();
  void tell_length(std::uint32_t cord, double length, double rate);
  bool is_in_contact(std::uint32_t cord) const;
  bool is_known_to_contact(std::uint32_t cord) const {
    return compiled_.contact && cord < compiled_.cords.rods.count();
  }
  bool is_held_by_contact(std::uint32_t cord) const;
  bool is_held_by_solver(std::uint32_t cord) const;
  const Place* place_of(std::uint32_t particle) const;
  bool is_asleep(std::uint32_t particle) const;
  void find_heads(std::span<const std::uint32_t> particles);
  Array<std::uint8_t> were_asleep(std::span<const std::uint32_t> particles) const;
  template <class Read, class Rest, class One>
  void read_all(std::span<Vec3> out, Read&& read, Rest&& rest, One&& one) const;
  Solver& solver(const Place& place) const { return *compiled_.solvers[place.solver]; }

  Settings settings_;
  SharingThresholds thresholds_;
  Workers workers_;
  Compiled compiled_;
  Anchors anchors_;
  Lengths lengths_;
  Array<std::uint8_t> reeled_;   ///< by rod: it is on a reel; empty if there are none
  Array<std::uint8_t> twisted_;  ///< by rod: it is of a twisted chain; empty if there are none
  Loads loads_;
  Grabs grabs_;
  Reactions reactions_;
  /// What islands that fell apart or are edited were made of.
  struct Origin {
    std::shared_ptr<const Scene> scene;
    Settings settings;
  };
  const Origin origin_;
  Breaks breaks_;  ///< of its scene
  Edits edits_;    ///< those that wait for the next step
  Vec3 gravity_, next_gravity_;
  Log log_;
  Population population_;
  bool has_archive_ = true, is_described_ = true;
  bool has_broken_ = false;  ///< some rod did in the last step
  bool is_to_fit_ = false;   ///< motion came from other settings, and is made to fit rods in the next step
  Array<Seat> seats_;        ///< by solver; free ones have none
  Array<std::uint8_t> is_loose_;  ///< by solver: an edit made it, and no pack since
  RodJudge rods_;
  Sleep sleep_;
  Events events_;
  double size_ = 0;  ///< m, which errors are relative to; 0 until it is known
  TimeRules rules_;
  Budget budget_;
  Zones zones_;
  Array<Stage> stages_;           ///< those that this scene needs
  double dt_ = 0;                 ///< length of this step, s
  Array<StepReport> reports_;     ///< one for each part of the team
  Array<std::uint32_t> visited_;  ///< solvers with a piece that is awake in this step
  Array<std::uint32_t> active_;   ///< tasks that parts share in this step
  Array<double> last_dt_;         ///< s, by solver: that of all of its tasks, or 0 if they differ
};

}  // namespace plumb::detail
