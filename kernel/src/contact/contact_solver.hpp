#pragma once

#include <algorithm>
#include <cstdint>
#include <functional>
#include <memory>
#include <optional>

#include "contact/cluster_mover.hpp"
#include "contact/clusters.hpp"
#include "contact/edits/given_numbers.hpp"
#include "contact/edits/kept_part.hpp"
#include "contact/edits/meeting.hpp"
#include "contact/edits/part_edits.hpp"
#include "contact/grabs/linkage_grabs.hpp"
#include "contact/linkage/scene_parts.hpp"
#include "contact/linkage/visitor.hpp"
#include "contact/pulls/contact_list.hpp"
#include "interface/archive.hpp"
#include "interface/made_solver.hpp"
#include "interface/solver.hpp"
#include "plumb/layouts/memory.hpp"

namespace plumb::detail {

/// Refuse a spring, torsion or angle that a world does not have.
[[noreturn]] void refuse_unknown(std::uint32_t number, const Spring&);
[[noreturn]] void refuse_unknown(std::uint32_t number, const Torsion&);
[[noreturn]] void refuse_unknown(std::uint32_t number, const AngleControl&);

/// Moves islands with bodies, joints or air, and every island with shapes while it may touch something.
///
/// Islands that may touch each other within a step are a cluster, and a cluster is a piece. Clusters are
/// formed anew at the beginning of every step. An island of particles and rods that nothing can reach stays
/// with its own solver (see Visitor).
class ContactSolver final : public Solver {
 public:
  /// Takes the islands of `parts` that have shapes, bodies, joints or air.
  ContactSolver(const std::shared_ptr<const Scene>& scene, const SceneParts& parts, const Settings& settings);

  /// Lets solver `number` of the world be an island's home, where its movable particles are at `slots`.
  void set_home(std::uint32_t island, Solver& home, std::uint32_t number, Array<Slot> slots);
  /// Names an island that its own solver can move, and the scene's numbers of its particles.
  struct PlainIsland {
    std::uint32_t island;
    std::span<const std::uint32_t> particles;  ///< movable ones first
    std::uint32_t movable;
  };
  Array<PlainIsland> plain_islands() const;

  // --- Edits (contact/edits)

  /// Returns whether a home may move the island of a particle while nothing touches it.
  bool may_go_home(Slot slot) const { return is_plain_[island_of_[slot]] != 0; }
  std::span<const std::uint32_t> particles_of(std::uint32_t island) const {
    return states_[island].particles;
  }
  std::uint32_t movable_of(std::uint32_t island) const { return states_[island].linkage->movable(); }
  Slot first_slot(std::uint32_t island) const { return first_slot_[island]; }
  /// Returns whether a rod of the scene is here, wherever its island is now.
  bool has_rod(std::uint32_t rod) const {
    return rod < owners_.rods.size() && owners_.rods[rod].island < ended;
  }
  /// Returns a movable particle of the island that has an item of a kind, if that is here.
  std::optional<std::uint32_t> mover_of(std::size_t kind, std::uint32_t number) const;
  /// Returns whether such a rod joins two particles of a body.
  bool is_of_body(std::uint32_t rod) const;
  /// Returns why such a rod cannot change its length, or null if it can.
  const char* keeps_length(std::uint32_t rod) const;
  /// See Solver. Rods have their numbers in the scene.
  void set_length(Slot rod, double length, double rate) override;
  /// Returns whether a capsule or a hull is still there.
  bool has_shape(ShapeId shape) const {
    const Array<Owner>& owners = owners_of(shape);
    return shape.number < owners.size() && owners[shape.number].island != ended;
  }
  /// Returns the particle around which alone a capsule is, if there is one. Where the scene has a line, its
  /// rod was cut.
  std::optional<std::uint32_t> middle_of(std::uint32_t capsule) const;
  /// Returns a capsule that is around a particle, with the scene's number of it.
  Capsule sphere(std::uint32_t capsule) const;
  /// Names an island that was made anew. It visits until its home is set if the one that it was of did.
  struct Made {
    std::uint32_t island;
    bool visits;
  };
  /// Makes islands anew with what is listed of them, as the islands that they are then. They end themselves.
  /// Those of particles and rods are plain again, if they have shapes; without, a home alone moves them.
  Array<Made> make_anew(std::span<const std::uint32_t> islands, const PartEdits& edits);
  /// Makes islands anew that come together. Shapes of plain ones go on where rods still join their places.
  Array<Made> make_met(Meeting of);
  /// Takes from the velocities of an island without a home what its constraints forbid since it was edited.
  void project_edited_velocities(std::uint32_t island);
  /// Returns what of a particle's island, such as "pin 3", could not move if it stood, with those that are
  /// marked by number. It is empty if there is nothing.
  std::string held_by(Slot slot, std::span<const std::uint8_t> is_fixed) const;
  /// Returns whether a body of the scene is here, rather than ground.
  bool has_body(std::uint32_t body) const {
    return body < owners_.bodies.size() && owners_.bodies[body].island < ended;
  }
  GivenNumbers& numbers() { return numbers_; }
  /// Has so many numbers. Nothing has those that are new.
  void resize_islands(std::uint32_t count);
  /// Returns whether a capsule of fixed particles alone is at one, which is ground.
  bool holds_ground(std::uint32_t particle) const {
    const auto anchors = surroundings_.anchored.anchors();
    return std::binary_search(anchors.begin(), anchors.end(), particle);
  }
  /// Takes in new islands. Those of particles and rods are plain, and at home from the start on.
  Array<Made> add(const NamedPart& part);
  /// Returns the scene's numbers of what an island has but its particles.
  const Names& names_of(std::uint32_t island) const { return names_[island]; }
  /// Lets an island with a home go on visiting.
  void stay_away(std::uint32_t island) { visitors_[island].stay(); }
  void remove(Slot slot) override;
  void end_contacts_of(const Names& gone);  ///< in the next step, since their shapes are removed

  // --- Other settings (contact/edits/contact_carry.cpp)

  /// Goes on as a solver of the same scene did under other settings. Islands that visited visit. All wake.
  void go_on_from(const ContactSolver& from);
  /// Lets islands sleep that did so there.
  void sleep_as(const ContactSolver& from);
  void wake_all();
  void fit(bool is_off) override;

  /// Returns whether this solver moves a particle now, rather than its home.
  bool has(Slot slot) const { return !visitors_[island_of_[slot]].is_at_home(); }
  bool is_asleep(Slot slot) const { return state_of(slot).asleep; }
  void tell(std::uint32_t piece, Troubles troubles) { clusters_.tell(pieces_[piece], troubles); }
  Troubles troubles(std::uint32_t island, bool also_lasting) const {
    return states_[island].troubles_now(also_lasting);
  }
  /// Names an island that went home in begin_step(), by its solver's number and one of its slots there.
  struct Return {
    std::uint32_t solver;
    Slot slot;
  };
  std::span<const Return> returned() const { return returned_; }
  /// Lets islands at home sleep here too if `is_resting(solver number, slot)` says that they rest there. Call
  /// it before begin_step().
  template <class IsResting>
  void see_rest(IsResting&& is_resting) {
    for (LinkageState& state : states_) {
      const Visitor& visitor = visitors_[state.number];
      if (state.asleep || !visitor.is_at_home() || !is_resting(visitor.number(), visitor.first_slot()))
        continue;
      std::fill(state.v.begin(), state.v.end(), Vec3{});
      clusters_.fall_asleep(state.number);
    }
  }
  /// See World::set_spring(), set_torsion() and set_angle().
  void set_law(std::uint32_t number, const Spring& spring);
  void set_law(std::uint32_t number, const Torsion& torsion);
  void set_law(std::uint32_t number, const AngleControl& angle);
  double torsion_angle(std::uint32_t number) const;
  /// Write how one acts now, all but its places; a torsion seeks its angle within half a turn of now.
  void read_law(std::uint32_t number, Spring& out) const;
  void read_law(std::uint32_t number, Torsion& out) const;
  void read_law(std::uint32_t number, AngleControl& out) const;

  /// See World::move_platform().
  void move_platform(std::uint32_t number, const Pose& target) {
    surroundings_.platforms.set_target(number, target);
  }
  /// Begins to move the ground through a step of dt (s), which wakes what sleeps on it. at(anchor) says where
  /// a fixed particle is (m) and its velocity (m/s) in the step. Call it before see_rest().
  template <class At>
  void begin_ground(double dt, At&& at) {
    for (const std::uint32_t anchor : surroundings_.anchored.anchors()) {
      const auto [position, velocity] = at(anchor);
      surroundings_.anchored.set(anchor, position, velocity);
    }
    surroundings_.begin_step(dt);
    wake_carried();
  }
  /// Puts fixed particles elsewhere (m), which wakes what sleeps where shapes on them were or are.
  void put_anchors(std::span<const std::uint32_t> anchors, std::span<const Vec3> positions);
  /// Ends a step, whether anything was awake in it or not.
  void after_step() {
    surroundings_.end_step();
    list_contacts();
  }
  /// Names the islands at home that the last begin_ground() or put_anchors() has woken.
  std::span<const Return> woken() const { return woken_; }

  /// Returns whether this solver moves a rod now, rather than a home, and knows how it pulls.
  bool has_pull(std::uint32_t rod) const {
    if (rod >= owners_.rods.size()) return false;  // joined where nothing has shapes
    const std::uint32_t island = owners_.rods[rod].island;
    return island < ended && states_[island].pulls.counts && !visitors_[island].is_at_home();
  }
  bool has_broken(std::uint32_t rod) const;  ///< a rod of the scene, here
  /// Returns the mean pull (N) of a rod of the scene in the last step. All means are NaN before the first.
  double pull_of_rod(std::uint32_t rod) const;
  double power_of_rod(std::uint32_t rod) const;  ///< W, likewise, with which it changed its length
  /// See World::pin_force() and its like.
  Vec3 pin_force(std::uint32_t pin) const;
  double angle_torque(std::uint32_t angle) const;
  Vec3 spring_force(std::uint32_t spring) const;
  double torsion_torque(std::uint32_t torsion) const;
  Vec3 contact_force(ShapeId shape) const;  ///< of a capsule or a hull
  /// Returns the force on ground, which has the opposite of what it pushes with.
  Vec3 force_on_ground(ShapeId ground) const { return ground_force(surroundings_.numbers.of(ground)); }
  std::span<const Contact> contacts() const { return contacts_.all(); }
  /// Takes from the initial velocities what constraints forbid. Returns the largest change in m/s.
  double project_initial_velocities();
  double project_initial_velocities(std::uint32_t island);  ///< likewise, of an island that has no home
  /// Returns the slots of the scene's particles.
  Array<MadeSolver::Place> places() const;
  std::uint32_t island_count() const { return static_cast<std::uint32_t>(states_.size()); }
  bool any_awake() const { return !clusters_.awake().empty(); }
  /// Returns whether enough islands are awake for several threads to win over one.
  bool is_worth_threads() const { return clusters_.awake().size() >= worth_threads; }

  /// Returns whether a piece is so much of the step's work that the whole team is to move it, on its own.
  bool is_for_team(std::uint32_t piece, unsigned parts) const;
  /// Calls advance(piece) for those, with the team's help.
  template <class Advance>
  void for_team_pieces(Team& team, Advance&& advance) {
    team_ = &team;
    for (std::uint32_t piece = 0; piece < pieces(); ++piece)
      if (is_for_team(piece, team.parts())) advance(piece);
    team_ = nullptr;
  }

  std::uint32_t pieces() const override { return static_cast<std::uint32_t>(pieces_.size()); }
  std::uint32_t islands(std::uint32_t piece) const override;
  std::uint32_t island_of(Slot slot) const override { return island_of_[slot]; }
  void begin_step(double dt, Team& team) override;
  /// Replaces begin_step() if no island is awake.
  void clear_pieces() { pieces_.clear(); }
  double advance(std::uint32_t piece, double h, std::uint32_t count, unsigned part, Tally& report) override;
  void begin_piece(std::uint32_t piece, unsigned part) override;
  void end_piece(std::uint32_t piece, double dt, unsigned part) override;
  Vec3 hold(Slot slot, double dt) const override;
  void end_step(StepReport& report) override;

  ErrorModel error_model() const override;
  double& best_substep(std::uint32_t piece) override;
  void save(std::uint32_t piece, Saved which) override;
  void restore(std::uint32_t piece, Saved which) override;
  void mark(std::uint32_t piece) override;
  double distance_from_mark(std::uint32_t piece) const override;

  bool has_changing_pieces() const override { return true; }
  bool set_stop_rule(const StopRule& rule) override;
  bool set_weights(Weights weights) override;
  bool is_slower(std::uint32_t, double) const override { return false; }
  void rest(std::uint32_t) override {}
  double size(std::uint32_t) const override { return 1; }

  Vec3 position(Slot slot) const override { return state_of(slot).x[local(slot)]; }
  Vec3 velocity(Slot slot) const override;
  void read_positions(std::span<const Run> runs, Vec3* out) const override;
  void read_velocities(std::span<const Run> runs, Vec3* out) const override;
  void add_to_hash(Slot slot, StateHash& hash) const override;
  double read(std::span<const Slot> slots, std::span<Vec3> out) const override;
  void set_force(Slot slot, Vec3 newton) override;
  const char* refuses_grab(std::span<const Slot> slots) const override;
  void put_grab(const HeldGrab& grab, std::span<const GrabShare> shares) override;
  void end_grab(std::uint32_t number) override;
  void aim_grab(std::uint32_t number, Vec3 velocity) override;
  void place_grab(std::uint32_t number, Vec3 target) override;
  const HeldGrab* held_grab(std::uint32_t number) const override;
  void set_gravity(Vec3 gravity, Vec3 change) override;
  void move_anchor(Slot slot, const AnchorMove& move) override;
  void place_anchor(Slot slot, Vec3 target) override;
  void set_motion(Slot slot, Vec3 position, Vec3 velocity) override;
  void set_away(Slot, bool) override {}
  bool is_away(std::uint32_t) const override { return false; }
  /// Movers keep nothing from step to step. What an accuracy saves stands within a step alone.
  void archive(Archive& archive) override {
    auto& [isa, relaxes, sleep, sleep_time, settings, time_order, surroundings, parts, linkages, uses, sums,
           numbers, grabs, states, visitors, is_plain, is_controlled, histories, first_slot, island_of,
           owners, names, rooms, gradients, ground_pushes, contacts, counts_pulls, counts_touches,
           lists_contacts, is_listed, clusters, pieces, work_of_pieces, team, returned, woken, rests, work,
           movers] = *this;
    archive(surroundings);
    for (LinkageState& state : states) archive(state);
    for (History& history : histories) archive(history.best_substep);
    for (IslandGrabs& of : grabs) archive(of);
    archive(visitors, ground_pushes, contacts, is_listed, clusters);
  }
  void describe(WorldInfo& info) const override;

 private:
  static constexpr std::size_t worth_threads = 16;
  static constexpr std::uint32_t no_island = 0xffffffff, ended = no_island - 1;

  /// Keeps what an attempt of a step is taken back to, if an accuracy is set.
  struct History {
    LinkageMotion saved[2];
    Array<Vec3> mark;
    double best_substep = 0;
  };

  /// Says where something of the scene is: an island, and its number there among those of its kind.
  struct Owner {
    std::uint32_t island, number;
  };
  /// Says where a particle was that moves: an island, and its number there.
  using Whereabouts = Array<std::pair<std::uint32_t, std::uint32_t>>;
  Whereabouts whereabouts() const;
  void take_motion(LinkageState& state, const ContactSolver& from, const Whereabouts& were) const;
  void take_step(LinkageState& state, const ContactSolver& from, const LinkageState& was,
                 std::span<const std::uint32_t> now) const;
  void take_laws(const ContactSolver& from);
  NamedPart named_part(std::uint32_t island) const;
  void copy_laws(const NamedPart& whole, const SceneParts& parts, std::uint32_t number, LinkageState& to,
                 bool with_plain_lengths) const;
  void begin_met(const Met& met, std::span<const std::uint32_t> names, std::span<const std::uint32_t> order,
                 LinkageState& state) const;
  static void edit(NamedPart& part, const PartEdits& edits);
  using IsPlain = std::function<bool(const SceneParts& parts, std::uint32_t part)>;
  using GoOn = std::function<void(const SceneParts& parts, std::uint32_t part, LinkageState& state)>;
  void replace(std::span<const std::uint32_t> islands, const NamedPart& by, const IsPlain& plain,
               const GoOn& go_on);
  void retire(std::uint32_t island);
  std::size_t kind_number(const LinkageState& state) const;
  std::size_t kind_like(const Scene& part);
  bool is_of_kind(std::size_t kind, const Scene& part) const;
  std::size_t add_kind(const Scene& part, KeptPart kept);
  void make_room(std::uint32_t count);
  std::uint32_t begin_island(std::size_t kind, const Scene& part, bool plain);
  ShapeId id_of(std::uint32_t island, std::uint32_t shape) const;
  const Array<Owner>& owners_of(ShapeId shape) const {
    return shape.kind == ShapeKind::hull ? owners_.hulls : owners_.capsules;
  }
  void rename(const NamedPart& part, const SceneParts& parts, std::span<const std::uint32_t> numbers);
  void wake_with_laws(LinkageState& state);
  IslandGrabs& grabs_of(std::uint32_t island);
  void make_kind(IslandGrabs& of);
  void begin_grabs(const LinkageState& state);
  void count_grabs(const LinkageState& state, double dt);
  template <class F>
  void for_grab(std::uint32_t number, F&& f);
  const Linkage* kind_of(const LinkageState& state) const;
  /// Returns a mean over the last step of what an island counts.
  template <class Number>
  static Number mean(const LinkagePulls& pulls, const Number& sum);
  /// Lets what the scene has be found in islands, and the other way round.
  void name(const SceneParts& parts, std::span<const std::uint32_t> number_of);
  /// Begins to count what the settings ask for.
  void begin_pulls(const Settings& settings);
  Vec3 ground_force(std::uint32_t ground) const;
  /// Makes the list of contacts of a step, and adds up what ground was pushed with.
  void list_contacts();
  LinkageState& state_of(Slot slot) { return states_[island_of_[slot]]; }
  const LinkageState& state_of(Slot slot) const { return states_[island_of_[slot]]; }
  void copy_positions(const Run& run, Vec3* out) const;
  std::uint32_t local(Slot slot) const { return slot - first_slot_[island_of_[slot]]; }
  bool is_fixed(Slot slot) const { return local(slot) >= state_of(slot).linkage->movable(); }
  void wake_carried();
  template <class IsMeant>
  void wake_those(IsMeant&& is_meant);
  bool is_carried(const LinkageState& state) const;
  bool rests(std::span<LinkageState* const> cluster, double dt) const;
  std::span<LinkageState* const> cluster(std::uint32_t piece) const { return clusters_[pieces_[piece]]; }
  bool can_stay_home(std::span<LinkageState* const> cluster) const;

  Isa isa_;
  bool relaxes_;  ///< clusters are relaxed, not solved
  bool sleep_;
  double sleep_time_;         ///< time (s) of being slow before an island sleeps
  ContactSettings settings_;  ///< multiplied by their length scale
  std::uint32_t time_order_;
  Surroundings surroundings_;
  Array<KeptPart> parts_;  ///< of linkages: one island that is of this kind
  Array<std::unique_ptr<Linkage>> linkages_;
  Array<std::uint32_t> uses_;  ///< by linkage: how many islands are of it
  Array<std::uint64_t> sums_;  ///< by linkage: over the likeness of its islands
  GivenNumbers numbers_;
  Array<IslandGrabs> grabs_;  ///< of islands that something grabs
  Array<LinkageState> states_;
  Array<Visitor> visitors_;       ///< by island's number
  Array<std::uint8_t> is_plain_;  ///< by island's number: it has particles, rods and shapes alone
  bool is_controlled_;            ///< An accuracy is set, and islands have histories.
  Array<History> histories_;
  Array<Slot> first_slot_;          ///< by island's number
  Array<std::uint32_t> island_of_;  ///< the island of each slot
  ByKind<Array<Owner>> owners_;     ///< by their numbers in the scene
  Array<Names> names_;              ///< by island's number: those of what it has
  Array<std::size_t> rooms_;        ///< by island's number: slots that fit behind its first one
  IslandGradients gradients_;
  Array<Vec3> ground_pushes_;  ///< N, by ground; none before the first step
  ContactList contacts_;
  bool counts_pulls_ = false, counts_touches_ = false, lists_contacts_ = false;
  bool is_listed_ = false;  ///< nothing was moved in the last step, and its list is made
  Clusters clusters_;
  Array<std::uint32_t> pieces_;     ///< the clusters that are moved here in this step
  std::size_t work_of_pieces_ = 0;  ///< islands of all of them
  Team* team_ = nullptr;
  Array<Return> returned_, woken_;
  Array<std::uint8_t> rests_;  ///< by cluster, set after its step: it may sleep
  ProjectionWork work_;
  Array<std::unique_ptr<ClusterMover>> movers_;  ///< one for each part of the team
};

}  // namespace plumb::detail
