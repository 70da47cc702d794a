#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <memory>
#include <optional>
#include <span>

#include "contact/cluster_island.hpp"
#include "contact/cluster_mover.hpp"
#include "contact/cluster_rows.hpp"
#include "contact/ground/ground_contacts.hpp"
#include "contact/ground/ground_search.hpp"
#include "contact/levers/lever.hpp"
#include "contact/linkage/flight.hpp"
#include "contact/linkage/linkage_state.hpp"
#include "contact/linkage/visitor.hpp"
#include "contact/near_pairs.hpp"
#include "contact/platforms/ground_now.hpp"
#include "contact/shapes/touch.hpp"
#include "contact/solved/cluster_limits.hpp"
#include "contact/solved/missed.hpp"
#include "contact/surroundings.hpp"
#include "interface/tally.hpp"
#include "plumb/layouts/memory.hpp"

namespace plumb::detail {

/// Returns the settings with all lengths and speeds multiplied by their length scale.
ContactSettings scaled(ContactSettings settings);

/// Moves islands that touch, or may within a step, through that step together.
///
/// A substep is RATTLE's with contacts. Constraints keep to the gradients of its start (gradient old), so
/// that one factorisation serves. Positions d go where momentum, forces and contacts take them,
///   M (d - h v - h²/2 M⁻¹f) = Jᵀ λ + Jcᵀ p,   C(x + d) = 0,   0 <= gap + Jc d  _|_  p >= 0,
/// with friction in Coulomb's cone. Then velocities d/h + h/2 M⁻¹f are projected onto the constraints at the
/// end. Where there was contact, they bounce or come to rest.
///
/// Gradients mid and new take constraints in its middle or at its end (Island::theta). The factors then lie
/// where the last substep lets expect, and corrections make up for what pulls turn by from there. Mid gets
/// its velocities, 2 d/h - v, without a projection, and acts where nothing pushes. New takes d/h, projected
/// where something does.
///
/// Elastics have rows of their own, see ElasticStep. Their matrix differs for positions and velocities, so
/// that islands with them take two factorisations.
///
/// Contacts act through what the linkage makes of a push, G = Jc P Jcᵀ, which takes one solve a row. Their
/// pushes are found by projected Gauss-Seidel on G (Moreau 1988; Jean 1999). An island that touches ground in
/// many places holds those contacts in its own matrix instead, see GroundContacts.
///
/// Without elastics energy does not rise. What a substep would gain is taken from the motion that is not that
/// of a rigid whole, which keeps momentum and angular momentum. In free flight gradient old gets back what it
/// would lose. With elastics it may rise by a share, see guard_elastics(), and driven, see guard_driven().
class ClusterStepper final : public ClusterMover, ClusterRows {
 public:
  /// The settings are scaled already (scaled()). `relaxed` moves what cannot be solved, if given, and what
  /// touches in many places if `relaxes_crowds`.
  ClusterStepper(Isa isa, const ContactSettings& settings, std::unique_ptr<ClusterMover> relaxed = nullptr,
                 bool relaxes_crowds = false)
      : kernels_(&simd::kkt_kernels(isa)),
        settings_(settings),
        relaxed_(std::move(relaxed)),
        relaxes_crowds_(relaxes_crowds) {}

  void step(std::span<LinkageState* const> cluster, const Surroundings& surroundings,
            const ClusterRules& rules, double dt, Tally& report) override;
  void forget() override {
    if (relaxed_) relaxed_->forget();
  }

 private:
  using Lanes = simd::Lanes;
  using Island = ClusterIsland;

  /// One side of a contact is on an island or, if that is `none`, on something fixed.
  struct Place {
    std::uint32_t island;
    const Combination& at;
    const Surface& surface;
    std::uint32_t shape = 0;           ///< its number, or that of the ground
    const GroundRate* rate = nullptr;  ///< of ground that moves
    std::optional<Segment> round{};    ///< of a capsule of the ground that a line touches
  };
  /// A contact that does not seem to come about in this substep, or to reach a sleeper.
  struct LeftOut {
    std::uint32_t island, other;
    Sum at, at_other;
    double gap;
    Vec3 normal, carried;
  };

  bool substep(const Surroundings& surroundings, double h, Tally& report);
  double solve(std::span<LinkageState* const> cluster, const Surroundings& surroundings, double h,
               double least, Tally& report);
  double solve_strained(std::span<LinkageState* const> cluster, const Surroundings& where, Tally& report);
  void take_displacements();
  bool relax_crowd(std::span<LinkageState* const> cluster, const Surroundings& surroundings,
                   std::uint32_t substeps, double dt, Tally& report);
  bool presses_as_crowd() const;
  bool relax(std::span<LinkageState* const> cluster, const Surroundings& surroundings, std::uint32_t substeps,
             double dt, Tally& report, bool with_bodies = false);
  bool can_relax(const LinkageState& state, double dt, bool with_bodies) const;
  bool relax_stuck(std::span<LinkageState* const> cluster, const Surroundings& where, double h, double& vain,
                   Tally& report);
  bool have_sunk(double h), has_ball_sunk(double most);
  void keep_strain();
  void hold_energy(Tally& report);
  std::uint32_t relaxed_substeps(double dt) const;
  bool bring_to_lengths(const Surroundings& surroundings);
  bool try_lengths(std::uint32_t i, const Surroundings& surroundings);
  bool bring_to_lengths(std::uint32_t i, double most, const Surroundings& surroundings);
  void find_ground_now(std::uint32_t i), find_walls(std::uint32_t i), find_walls_of_others(std::uint32_t i);
  void find_walls_between(std::uint32_t i, std::uint32_t j);
  bool find_depths(std::uint32_t i), has_gone_far(std::uint32_t i);
  bool fit(std::span<LinkageState* const> cluster, const Surroundings& surroundings);
  void buckle(std::span<LinkageState* const> cluster, const Surroundings& surroundings);
  bool find_buckling(bool is_found);
  void unbalance();
  bool make_room(std::uint32_t i, double share, const Surroundings& surroundings);
  void keep_motion(std::span<LinkageState* const> cluster);
  void return_to_motion(std::span<LinkageState* const> cluster);
  double longest_substep(double most, double turn);
  bool is_alone(const Surroundings& surroundings, double h) const;
  bool fly(std::uint32_t time_order, double h, Tally& report);
  void begin_given(Island& island, double h);
  void start(Island& island, double h);
  void predict(Island& island);
  double theta_of_substep(const LinkageState& state) const;
  bool is_held() const, turns() const, keeps_energy() const;
  bool leaves_middle();
  static void turn(Island& island);
  static void turn_anew(Island& island);
  static void take_turning(Island& island, std::span<const Vec3> by);
  static double add_lag(Island& island);
  static void take_lag(Island& island, double share);
  static bool end_turned(Island& island, double h, bool touched);
  static bool factor_on_ground(Island& island, bool is_end);
  bool start_on_ground(Island& island);
  /// Says how far corrections of all islands are.
  struct Progress {
    double violation = 0;  ///< the largest
    double to_do = 0;      ///< the largest over what is wanted
    bool lacks = false;    ///< some ground does not push as it should
  };
  double sweep(int correction, int& sweeps);
  bool correct(Island& island, int correction, Progress& progress, Tally& report);
  bool correct_on_ground(Island& island);
  void find_velocities_on_ground(Island& island);
  void balance_velocities(Island& island);
  void fill_velocities(Island& island);
  bool is_on_ground() const;
  bool try_otherwise(Tally& report);
  std::uint64_t count_points() const;
  bool will_come_taut();
  bool is_landing() const, any_touch() const, any_bends() const;
  std::size_t count_pushes() const;
  void freeze(Island& island, Tally& report);
  void begin_elastics(Island& island, double h) const;
  static void aim_elastics(Island& island);
  static double elastic_misfit(Island& island);
  static void pull_elastics(Island& island, double share);
  void end_elastics(Island& island, double h);
  static bool let_go_at_end(Island& island);
  static void keep_elastics(Island& island, double h);
  static void hold_elastics(Island& island);
  bool switch_elastics();
  bool let_go_of_held(bool is_found);
  bool hardly_answers(const Row& row) const;
  /// Squares of pushes times what they move an island by, and would move free particles by, kg m².
  struct Answer {
    double given = 0, free = 0;
    bool is_little() const { return given < contact_limits::straight * free; }
  };
  Answer answer(Island& island, std::uint32_t i) const;
  static void add_push(const Island& island, const Side& side, double by, std::span<Vec3> pushes);
  static bool let_go(Island& island, const Side& side);
  bool find_sound_positions(double h, Tally& report);
  void find_stillness(double h);
  bool learn_tautness(double h);
  bool find_positions(double h, Tally& report);
  bool find_missed_contacts();
  void find_contacts(double h), wake(std::uint32_t i);
  void find_bounds(Island& island) const;
  void find_sights(Island& island) const;
  double work_of_ground(double h) const;
  double work_of_given(Array<double> Island::*pulls, double at), work_of_common(double h);
  double opened(const Row& row) const;
  static double opened(const Island& island, const GroundContact& contact);
  double work_of_recovery() const;
  void touch_planes(std::uint32_t i, double h), touch_boxes(std::uint32_t i, double h);
  void touch_anchored(std::uint32_t i, double h), touch_ground(std::uint32_t i, double h);
  void touch_ends(std::uint32_t i, std::uint32_t ground, double h);
  Place place_on(std::uint32_t ground) const;
  static MovingSegment motion_of(const Island& island, const Linkage::Shape& shape);
  static MovingHullShape hull_motion(Island& island, std::uint32_t hull);
  bool passes_ground(const Island& island, const Surroundings& surroundings);
  bool find_missed(), find_missed_ground(), find_missed_pairs();
  void find_missed_pairs(std::uint32_t i, std::uint32_t j);
  void touch_missed_pairs(std::uint32_t i, std::uint32_t j, double h);
  void touch_island(std::uint32_t i, std::uint32_t j, double h);
  void touch_itself(std::uint32_t i, double h);
  void touch_capsules(std::uint32_t i, std::uint32_t k, std::uint32_t j, std::uint32_t l, double h);
  static void place_hulls(Island& island);
  static PlacedShape placed(Island& island, std::uint32_t number);
  void touch_island_hulls(std::uint32_t i, std::uint32_t j, double h);
  /// The first place is on an island.
  void add_contact(const Place& a, const Place& b, const Touch& touch, std::uint64_t key, double h);
  bool touches_others(std::uint32_t i) const;
  bool may_rock(std::uint32_t i, double h) const;
  void spread_ground(std::uint32_t i, double h);
  void note_touch(const GroundContact& contact, std::span<const ContactEnd> ends);
  void add_contact_rows(const GroundContact& contact, std::span<const ContactEnd> ends, double h);
  void add_turning_rows(const GroundContact& contact, std::span<const ContactEnd> ends, std::uint32_t normal,
                        double h);
  bool turns(const Levers::End& end) const;
  bool is_on_face(const Levers::End& end, Vec3 outward);
  void move_place(const Levers::End& end, Vec3 by);
  void add_round_contact(const GroundContact& contact, std::span<const ContactEnd> ends, std::uint32_t row);
  Touch nearest(const RoundContact& contact, bool with_motion) const;
  void follow_gaps(), follow_round(), renew_levers();
  void move_end(Levers::End& end, std::span<const Vec3> axes, double share, double sign, double beyond);
  void renew_lever(const Levers& contact, const Levers::End& end, Vec3 arm);
  void add_angles(std::uint32_t i, double h);
  static Sum add_sum(Island& island, Terms sum);
  static std::uint32_t add_side(Island& island, const Side& side);
  static std::uint32_t add_side(Island& island, const Lever::Rate& rate, double sign);
  void find_responses(bool of_others_alone);
  bool renew_responses();
  static double couple_ends(Row& row);
  static SideUnknowns gather(const Island& island, const Side& side);
  void couple(Island& island);
  static void add_pushes(Island& island);
  void add_responses(Island& island);
  static void solve_pushes(Island& island);
  void see(Island& island, std::span<const Vec3> motion);
  double see(const Row& row);
  /// Returns how a row moves against what it touches, in m or m/s.
  template <double Row::*of>
  double slide(const Row& row);
  bool is_held_in_ground(const Row& row);
  bool is_driven_in(const Row& row);
  void push(const Row& row, double by);
  void push(const Row& first, double by0, double by1, double by2);
  void find_yielding(), push_held();
  double wanted(const Row& row, double whole, double u) const;
  /// Whether a sweep pushes or only says how far it would.
  enum class Sweep : std::uint8_t { pushes, looks };
  template <double Row::*of, Sweep sweep>
  double set(Row& row, double value);
  template <double Row::*of, Sweep sweep>
  double contact(std::size_t r, double wanted, double kept);
  template <double Row::*of, Sweep sweep>
  double roll(std::size_t r, double most);
  void apply(Island& island, std::span<Vec3> motion);
  template <Sweep sweep>
  double sweep_positions();
  template <Sweep sweep>
  double sweep_velocities();
  template <double Row::*of>
  double sweep();
  template <double Row::*of>
  void push_on(double share);
  template <double Row::*of>
  void keep_pushes(Array<double>& to) const;
  template <double Row::*of>
  bool turn_back() const;
  template <double Row::*of>
  void go_on(double share);
  template <double Row::*of>
  double sweep_on(double till, int most, int alone, int& sweeps);
  bool is_wide() const;
  /// Returns whether contacts are so many that some come and go in each correction, and disturb constraints.
  bool is_crowded() const { return is_wide_ || rows_.size() > contact_limits::few_rows; }
  double see_freely(const Row& row) const;
  void push_freely(const Row& row, double by);
  void push_freely(const Row& first, double by0, double by1, double by2);
  void add_free_terms(std::size_t r);
  void find_free_responses();
  void lay_pushes();
  template <double Row::*of>
  void follow_free(Island& island, Array<Vec3>& motion);
  template <double Row::*of>
  static Array<Vec3>& motion_of(Island& island);
  template <double Row::*of>
  void extrapolate(double share);
  template <double Row::*of>
  void keep_last();
  template <double Row::*of>
  void begin_free();
  template <double Row::*of>
  void end_free();
  template <double Row::*of>
  double sweep_freely(double enough, double share, int most, int& sweeps);
  bool solve_positions(Tally& report);
  void finish(double h, bool touched);
  void find_velocities(Island& island);
  void bounce(double h);
  void brake(Island& island, double h);
  /// `before` (J) is the energy before the substep, and what ground, anchors and rods that go have added
  /// since. `recovered` (J) is what ending overlaps may have lifted.
  bool guard_energy(double before, double recovered, bool touched, bool can_shorten, Tally& report);
  double energy() const, elastic_energy() const, weight() const, kinetic() const;  // J
  std::pair<double, double> kinetic_and_potential() const;
  bool is_passive() const, flies() const;
  void take_back(), stop();
  /// Energies of what is awake, J.
  struct Energies {
    double all = 0, moving = 0;  ///< with and without that of weight and constant forces
  };
  Energies energies_of_elastics() const;
  static void make_room_to_damp(Island& island);
  void slow_down(double excess, double kinetic), slow_all(double excess, double moving);
  bool guard_elastics(const Energies& before, bool touched, bool can_shorten, Tally& report);
  double driving_energy(const Surroundings& surroundings) const;  // J
  bool guard_driven(double before, const Surroundings& surroundings, bool can_shorten);
  bool guard(double before, const Energies& held, bool touched, bool can_shorten, Tally& report);
  double find_rigid_motion();
  void find_common_motion();
  void scale_loose_motion(double by), slow_trembling(double excess);
  void keep_contacts(double h), find_pushed_out(double h);
  static std::array<double, 2> impulses_of(const Island& island, std::size_t elastic, double h);
  /// Breaks rods that pulled too much in the substep that has ended. Returns how many.
  static std::uint32_t break_rods(Island& island, double h);
  /// Remembers the rod that is pulled farthest beyond its strength in a substep that is not solved. If
  /// shorter ones are not either, rods do not fit together.
  void find_overload();
  /// Breaks that rod then. Returns whether there was one.
  bool break_overload(Tally& report);
  void count_pulls(Island& island, double h) const;
  void count_pushes(const Row& row, double h);
  void count_touch(const RowsTouch& touch, double h);
  void count_pushes(double h);

  const simd::KktKernels* kernels_;
  ContactSettings settings_;
  std::unique_ptr<ClusterMover> relaxed_;
  bool relaxes_crowds_;
  ProjectionWork projection_;
  Array<LinkageMotion> before_;  ///< what to return to
  Array<Island> islands_;
  /// A rod that is pulled beyond its strength in a substep that is not solved.
  struct Overload {
    LinkageState* state = nullptr;
    std::size_t rod = 0;
  } overload_{};
  std::uint32_t count_ = 0;
  Array<Row> rows_;
  Array<Levers> levers_;
  Array<RoundContact> round_contacts_;
  Array<RowsTouch> touches_;  ///< empty unless they count
  Array<LeftOut> left_out_;
  NearPairs own_pairs_;                         ///< of one island's shapes
  Array<Bounds> own_bounds_;                    ///< around those
  NearPairs near_islands_, close_islands_;      ///< which may touch in this substep, and within a step
  Array<Bounds> island_bounds_;                 ///< of which such pairs are
  Array<double> top_speeds_;                    ///< m/s, of islands
  const Surroundings* surroundings_ = nullptr;  ///< of this step
  GroundNow ground_;                            ///< as the substep starts
  Array<std::uint32_t> near_ground_;            ///< an island's or a shape's, ascending
  Array<MissedGround> missed_ground_;
  Array<MissedPair> missed_pairs_;
  bool gives_up_missed_ = false, gives_way_ = false;  ///< something is in ground still; nets may be strained
  bool may_sink_ = true, may_strain_ = true, sinks_ = false;  ///< by what is relaxed; something would sink
  Strain strain_ = Strain::none;                 ///< how rods may be off their lengths, in what is relaxed
  double most_moved_ = 0;                        ///< m, of what rods at their lengths have moved
  bool goes_through_ = false;                    ///< other islands, as its rods are brought to their lengths
  double deepest_ = 0;                           ///< m, beyond the slop, as find_depths() found it
  bool all_near_ = false, may_touch_ = false;    ///< the last: something pushes, or is near
  bool looks_for_crowd_ = false;                 ///< what presses in many places is relaxed instead
  bool found_crowd_ = false, in_crowd_ = false;  ///< and does; what gives is relaxed in it
  bool is_fitted_ = false, has_looked_ahead_ = false;  ///< rods were fitted in this step, or to where it ends
  bool is_buckled_ = false, buckles_ = false;          ///< rods were nudged aside in this step, or are to be
  bool friction_waits_ = false;                        ///< sweeps change normal pushes alone
  bool has_momentum_ = false, has_nets_ = false;  ///< sweeps go on the way they went; some island is a net
  double kept_of_overlaps_ = 1;                   ///< the share of their pushes that sweeps keep
  bool is_unfound_ = false;  ///< the last try found no positions, rather than that something gained energy
  bool loose_ = false, sweeps_ground_ = false;    ///< ground grips loosely, or is swept, as nothing was found
  bool is_wide_ = false, knows_answers_ = false;  ///< pushes are found freely; responses are those of rows_
  Array<FreeTerm> free_terms_;
  Array<double> last_pushes_, swept_from_;        ///< then, of rows
  bool keeps_slack_ = false, takes_end_ = false;  ///< what is slack is known; what gained energy is to damp
  int switches_ = 0, halvings_ = 0;               ///< how often that was changed in it; those of this step
  Rounds rounds_;
  Flight flight_;
  bool tight_ = false, tries_again_ = false;  ///< sweeps go on for longer; a substep is to be tried so
  bool rests_ = false;        ///< nothing is faster than what may sleep, as the substep begins
  bool is_stopped_ = false;   ///< in this step, as something was lifted; sweeps do so in any substep
  bool is_squeezed_ = false;  ///< what drives throws it or presses it into ground, however short a substep is
  double now_ = 0, left_ = 0;                     ///< s, since the beginning of the step, and until its end
  double shortest_ = 0, shortest_if_missed_ = 0;  ///< s; the latter where something is in ground still
  Team* team_ = nullptr;                          ///< that may help what is relaxed
  double recovery_rate_ = 0;           ///< 1/s, the share that is taken back of overlaps and beyond limits
  double still_ = 0, swept_left_ = 0;  ///< m, changes of a position: one that no longer matters, the last one
};

}  // namespace plumb::detail
