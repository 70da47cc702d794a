#pragma once

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <optional>
#include <span>

#include "contact/lengths/rod_lengths.hpp"
#include "contact/linkage/linkage.hpp"
#include "contact/shapes/bounds.hpp"
#include "interface/problems.hpp"
#include "plumb/layouts/memory.hpp"
#include "plumb/settings.hpp"
#include "time/leftovers.hpp"

namespace plumb::detail {

/// Holds the forces of a contact, from which the next substep starts. Those on the way and those at the
/// substep's end are kept apart, because they differ in the same way for many substeps.
struct KeptContact {
  std::uint64_t key = 0;
  Vec3 force{}, end_force{};  ///< N
};

/// Says why rods are off their lengths: they are drawn too far, or ground is in their way.
enum class Strain : std::uint8_t { none, drawn, pressed };

/// Holds what steps change of an island.
struct LinkageMotion {
  Array<Vec3> x, v;          ///< m and m/s; fixed particles too
  Array<Vec3> acceleration;  ///< (displacement of the last substep - h v)/h², m/s²
  Array<Vec3> anchors_went;  ///< m/s, in the last substep, by which its velocities are
  Array<KeptContact> kept;
  bool asleep = false;
  bool frozen = false;
  double elapsed = 0;              ///< s, since the beginning of the step
  bool on_ground = false;          ///< its matrix held contacts with ground in the last substep
  std::uint8_t relax_for = 0;      ///< so many steps, because it could not be solved
  bool is_relaxed = false;         ///< method auto relaxed its last step
  Strain strain = Strain::none;    ///< its rods do not fit, and are relaxed
  double slow_time = 0;            ///< time for which it has been slow, s
  Vec3 slow_from{};                ///< m/s, its mean velocity when it became slow
  std::optional<double> energy{};  ///< J, that free flight keeps, or that elastics may have
  double most_motion = 0;          ///< J, most of kinetic and elastic energy since that was noted
  Array<double> elastic_numbers;   ///< m or rad, of elastics; turns are counted by them
  /// How fast these changed in the last substep, m/s or rad/s: not a number of what did not act, and none if
  /// it is unknown.
  Array<double> elastic_rates;
  LinkagePulls pulls;  ///< of the last step
  /// How stiff taut rods were across themselves in the last two substeps, kg/s². None if there are no such
  /// rods.
  Array<double> stiffness, stiffness_before;
  bool knows_tautness = false;  ///< those are of substeps
  Array<double> waves_before;   ///< kg, LinkageState::wave_inertia in the last substep
  /// It has 1 for rods that have broken, of those that give; none if no rod may.
  Array<std::uint8_t> broken;
  RodLengths lengths;             ///< where the last substep ended, or the next step starts
  Leftovers leftovers;            ///< of sweeps, where they are all that keeps rods at their lengths
  Array<double> kept_violations;  ///< m², by rod, see Leftovers; none if nothing is kept
};

/// Holds one island of a linkage's kind, wherever it is.
struct LinkageState : LinkageMotion {
  /// Starts where the part of a scene does that the kind is made of, or one like it. It sleeps if all movable
  /// particles do. Where it `relaxes` by sweeps alone, there is room for what these leave.
  LinkageState(const Linkage& kind, std::uint32_t island, const Scene& part, bool relaxes = false);
  /// Has ended, or not begun.
  explicit LinkageState(std::uint32_t island) : linkage(nullptr), number(island) { asleep = true; }

  const Linkage* linkage;
  Array<std::uint32_t> particles;  ///< the scene's numbers
  Array<Vec3> force;               ///< N, constant, on movable particles
  Array<ElasticLaw> laws;          ///< of elastics
  /// How a pull of one moves each elastic where find_gives() was called last, in 1/kg or 1/(kg m²).
  Array<double> gives;
  Array<Linkage::AngleRule> angle_rules;
  Array<simd::Block> factors;         ///< of the matrix at x
  std::uint32_t number;               ///< the island's number
  std::uint32_t heap = number;        ///< of a sleeper in a cluster, who wakes with all of that heap
  Gradient gradient = Gradient::old;  ///< where it is solved
  bool factored = false;
  bool is_pushed_out = false;     ///< solved contacts took back overlaps in the last substep
  Troubles troubles = 0;          ///< what went wrong in its last step awake
  Array<double> wave_inertia_at;  ///< kg, of particles: the sum of that of their rods
  Array<double> wave_inertia;     ///< kg, of taut rods in the substep under way; see find_wave_inertia()
  Array<double> turning;          ///< kg, of taut rods in the matrix of gradient mid, or none

  LinkageMotion& motion() { return *this; }
  /// Goes on as an island of another kind, which has other grabs alone. Their targets stand at the ends of
  /// positions and velocities.
  void take_kind(const Linkage& kind);
  /// Goes on as another island did, of which it has the particles `of`, in order.
  void go_on_from(const LinkageState& from, std::span<const std::uint32_t> of);
  /// Let one of the island act as number `old` of another island does: what programs changed of it, turns,
  /// and what broke.
  void keep_rod(const LinkageState& from, std::uint32_t old, std::uint32_t own);
  void keep_angle(const LinkageState& from, std::uint32_t old, std::uint32_t own);
  void keep_spring(const LinkageState& from, std::uint32_t old, std::uint32_t own);
  void keep_torsion(const LinkageState& from, std::uint32_t old, std::uint32_t own);
  /// Lets nothing be left of the island but its number.
  void end();
  /// Goes on from a motion that was copied from motion().
  void return_to(const LinkageMotion& motion);

  /// Takes from what went wrong with its cluster in a step what is the island's own, and with `others` what
  /// is of no certain one.
  void take_troubles(Troubles of_cluster, bool others);
  /// Returns what went wrong in the last step if it is awake, and what lasts of it with `also_lasting`.
  Troubles troubles_now(bool also_lasting) const;
  /// Notes at the end of a step of dt (s) whether it is slow.
  void follow_slowness(bool is_slow, double dt);
  /// Returns how much its mean velocity (m/s) changes in a time (s), if it goes on as since it is slow.
  double change_within(double time) const;
  /// Begins a substep of h (s): slows waves that it cannot follow. Or lets all waves be as they are.
  void slow_waves(double h);
  void free_waves();
  /// Lets the matrix of gradient mid know how pulls turn with their rods. Without that, corrections lead
  /// nowhere where loads hang from light rods.
  void follow_turning(std::span<const double> multipliers);
  /// Ends it, with the multipliers of positions.
  void follow_tautness(std::span<const double> multipliers, double h);
  void forget_tautness() {
    knows_tautness = false;
    std::fill(stiffness.begin(), stiffness.end(), 0.0);
    std::fill(stiffness_before.begin(), stiffness_before.end(), 0.0);
    forget_waves();
  }
  /// Lets all waves be as they are. Those that are slowed from then on begin at rest.
  void forget_waves() {
    free_waves();
    std::fill(waves_before.begin(), waves_before.end(), 0.0);
  }
  /// Takes multipliers of a first try for those of the last two substeps, if none are known. Returns whether
  /// that slows any waves.
  bool learn_tautness(std::span<const double> multipliers, double h);
  /// Returns the momenta of motions with the inertia of waves, and their product with these motions.
  void momenta(std::span<const Vec3> motions, std::span<Vec3> out) const;
  /// Returns the inertia of waves that moves as a substep starts. What they had not before is at rest, since
  /// it would get energy from nothing if it moved along, which is more than all where a chain comes taut.
  /// Where anchors or winches drive an island, it moves along all the same.
  std::span<const double> waves_at_start() const;
  void start_momenta(std::span<const Vec3> motions, std::span<Vec3> out) const;
  double inertia_product(std::span<const Vec3> motions) const;
  /// Returns the mass of a place's heaviest movable particle with the inertia of its waves, kg.
  double heaviest(Terms at) const;

  /// Lets what held contacts in a substep much shorter than those before go on as an impulse in a longer one,
  /// and not as a force. A blow is over by then, and would throw what landed.
  void limit_kept(double h) {
    const double share = leftovers.force_share(h);
    if (asleep || share == 1) return;
    for (KeptContact& each : kept) each.force = share * each.force;
  }
  void forget_leftovers() {
    leftovers = {};
    kept_violations.clear();
  }
  /// Lets the island stand still for good. Nothing of it stays that may not be finite: NaN has a sign that
  /// depends on the instruction set, and snapshots hold it.
  void freeze() {
    frozen = true;
    kept.clear();
    energy.reset();
    forget_leftovers();
    std::fill(acceleration.begin(), acceleration.end(), Vec3{});
    forget_tautness();
  }
  /// Lets a rod pull nothing from now on.
  void break_rod(std::size_t elastic);
  /// Breaks the rods whose mean pull over a substep, pull_of(elastic) in N, is more than they hold. They pull
  /// nothing from now on. Returns how many there are.
  template <class PullOf>
  std::uint32_t break_rods(PullOf&& pull_of) {
    std::uint32_t count = 0;
    for (std::size_t i = 0; i < broken.size(); ++i)
      if (std::isfinite(laws[i].strength) && pull_of(i) > laws[i].strength) {
        break_rod(i);
        ++count;
      }
    return count;
  }
  /// Factorises the matrix at x, without elastics. Returns false if it has no factors.
  bool factor() {
    assemble(x);
    return factored = linkage->plan().factor(factors);
  }
  /// Factorises it with elastics, and with directions at x or where else they are to be taken: soft(i) is
  /// 1/kg or 1/(kg m²), or less than 0 for one that takes no part.
  template <class Soft>
  bool factor_with_elastics(Soft&& soft) {
    return factor_with_elastics(x, soft);
  }
  template <class Soft>
  bool factor_with_elastics(std::span<const Vec3> at, Soft&& soft) {
    assemble_with_elastics(at, soft);
    return linkage->plan().factor(factors);
  }
  /// Writes that matrix into its factors, with directions in a configuration.
  template <class Soft>
  void assemble_with_elastics(std::span<const Vec3> at, Soft&& soft) {
    assemble(at);
    const std::span<const Elastic> elastics = linkage->elastics();
    for (std::size_t i = 0; i < elastics.size(); ++i)
      if (const double own = soft(i); own >= 0)
        linkage->couple(elastics[i], linkage->slope(elastics[i], at), std::max(own, least_soft(i)), factors);
    factored = false;
  }
  /// Solves with the factors. `unknowns` holds right hand sides, then the solution: multipliers of
  /// constraints, and what particles move by.
  void solve(Array<simd::Quad>& unknowns) const {
    if (!flat_gradients_.empty()) linkage->push_flat(flat_gradients_, numbers(unknowns));
    linkage->plan().solve(factors, unknowns);
  }
  /// Notes how fast anchors and lengths went in a substep.
  void keep_given() {
    std::copy(v.begin() + linkage->movable(), v.end(), anchors_went.begin());
    lengths.end_substep();
  }
  /// Writes -J v of some particles at x into the places of `right`, and what rods that change their length
  /// ask for.
  void rates(std::span<const Vec3> velocities, Linkage::Range of, std::span<double> right) const;
  /// Returns whether anchors move or rods change their length, which does work.
  bool is_driven() const;
  /// Returns the most energy (J) that goes where anchors and lengths change how fast they go, as in a blow.
  double most_of_blow() const;
  double driving_speed() const;      ///< how fast anchors and lengths go at most, m/s
  Vec3 velocity_of_anchors() const;  ///< in the mean, m/s
  /// Returns what multipliers of constraints at x do as rods change their length, and as anchors go beside
  /// their mean: J for those of an impulse. Overwrites `unknowns`.
  double work_of_given(std::span<const double> multipliers, Array<simd::Quad>& unknowns);
  /// Returns what that mean does (J) in a substep of h (s) that ends with velocities `after`, if nothing else
  /// pushes: it gives all momentum but that of weight and constant forces.
  double work_of_common(std::span<const Vec3> after, double h);
  /// Takes again from velocities of redundant constraints at x what those forbid. Overwrites `unknowns`, and
  /// adds its multipliers to those that are given, if any.
  void correct_velocities(std::span<Vec3> velocities, Array<simd::Quad>& unknowns,
                          std::span<double> multipliers = {}) const;
  /// Finds the gives of elastics at x, and factorises the matrix there without them. They change as things
  /// turn: a spring over its dead centre has none.
  void find_gives();
  /// Returns whether one of a bend's rods is broken.
  bool has_ended(const BendElastics& bend) const;
  /// Lets the laws of bends follow them to where they are in the middle of a substep of h (s).
  void follow_bends(double h);
  /// Finds the elastics' numbers at x. After a substep of h (s) it finds their rates as well.
  void follow_elastics();
  void follow_elastics(double h);
  /// Adds the constant pulls of elastics at x, such as those of motors, to forces (N).
  void add_motors(std::span<Vec3> forces) const;
  /// Returns how far (m) elastics throw a place of the island's shapes in dt (s) at most.
  double throw_by_elastics(double dt) const;
  /// Returns what elastics hold at x, J, with the constant pulls that are added.
  double elastic_energy() const;
  /// Returns whether elastics hold or take energy: springs, dampers and bends do, and rods that are rigid
  /// until they break or hang slack do not.
  bool trades_energy() const;
  /// Returns what an elastic pulls with at x and v by its stiffness and damping, in N or N m.
  double elastic_pull(std::size_t i) const;
  /// Adds all that elastics pull with, at x and v.
  void add_elastic_pulls(std::span<Vec3> forces) const;
  /// Adds the impulses of constant pulls in `h` (s) at `where`, of elastics whose numbers are near `near(i)`.
  template <class Near>
  void count_motors(double h, std::span<const Vec3> where, Near&& near) {
    for (std::size_t i = 0; i < laws.size(); ++i) {
      const ElasticLaw& law = laws[i];
      if (law.force == 0) continue;
      if (law.one_sided && linkage->number(linkage->elastics()[i], where, near(i)) <= law.rest) continue;
      linkage->count_pull(i, where, h * law.force, pulls);
    }
  }
  /// Returns what the matrix lets constraints give to a push along all of them, 1/kg. Elastics that are as if
  /// rigid count as constraints.
  double softness() const {
    double sum = linkage->softness();
    for (std::size_t i = 0; i < laws.size(); ++i)
      if (std::isinf(laws[i].stiffness)) sum += softest * gives[i];
    return sum;
  }
  /// Returns whether a step of h (s) that is not implicit can follow all elastics.
  bool can_follow_elastics(double h);

 private:
  void keep_elastics(const LinkageState& from, Linkage::ElasticRange old, Linkage::ElasticRange own);

  double find_elastic_pulls() const;

  static constexpr double softest = 1e-11;
  /// What is rigid has this share of its particles' response on the diagonal, or something where none moves.
  double least_soft(std::size_t i) const { return gives[i] > 0 ? softest * gives[i] : 1; }
  void assemble(std::span<const Vec3> at) {
    factors.resize(linkage->plan().blocks());
    linkage->assemble(at, factors);
    flat_gradients_.resize(linkage->flat_rods());
    linkage->find_flat_gradients(at, flat_gradients_);
    if (!wave_inertia.empty()) linkage->add_wave_inertia(wave_inertia, factors);
    if (!turning.empty()) linkage->add_wave_inertia(turning, factors);
  }

  Array<Vec3> flat_gradients_;  ///< 1/m, of rods of flat bodies where the matrix was assembled
  Array<simd::Quad> unknowns_;
  Array<Vec3> push_, given_;
  mutable Array<Vec3> pulls_;       ///< N, see find_elastic_pulls()
  mutable Array<double> energies_;  ///< J, likewise
};

/// Returns whether capsules of two islands are at one fixed particle, by their numbers. They overlap there as
/// neighbours on a rope do, and do not touch either.
bool hang_together(const LinkageState& one, std::uint32_t capsule, const LinkageState& other,
                   std::uint32_t other_capsule);
/// Returns that of a capsule, or a hull, and a capsule between fixed particles, with the scene's numbers of
/// these.
bool hang_together(const LinkageState& one, std::uint32_t shape, const Linkage::Shape& anchored);
/// Returns how far constant forces throw an island in dt (s), m.
double throw_of(const LinkageState& state, double dt);
/// Returns a box around an island's shapes, wherever gravity and the speed (m/s) of its fastest movable
/// particle bring them within dt (s). The margin (m) is that of contact.
///
/// The box leaves out what goes farther: ends of shapes beyond the particles, anchors that move, and what
/// hits within dt add. Forces and elastics throw it no farther than so many times its size.
Bounds reach(const LinkageState& state, double speed, double dt, double margin);
/// Returns the speed of the fastest particle, m/s.
double top_speed(const LinkageState& state);
/// Returns the root mean square of the speeds (m/s) of an island's movable particles, by mass.
double mean_speed(const LinkageState& state);

template <class Archive>
void visit_members(Archive& archive, KeptContact& of) {
  auto& [key, force, end_force] = of;
  archive(key, force, end_force);
}
template <class Archive>
void visit_members(Archive& archive, LinkageMotion& of) {
  auto& [x, v, acceleration, anchors_went, kept, asleep, frozen, elapsed, on_ground, relax_for, is_relaxed,
         strain, slow_time, slow_from, energy, most_motion, elastic_numbers, elastic_rates, pulls, stiffness,
         stiffness_before, knows_tautness, waves_before, broken, lengths, leftovers, kept_violations] = of;
  archive(x, v, acceleration, anchors_went, kept, asleep, frozen, elapsed, on_ground, relax_for, is_relaxed,
          strain, slow_time, slow_from, energy, most_motion, elastic_numbers, elastic_rates, pulls, stiffness,
          stiffness_before, knows_tautness, waves_before, broken, lengths, leftovers.time, leftovers.last,
          kept_violations);
}
template <class Archive>
void visit_members(Archive& archive, Linkage::AngleRule& of) {
  auto& [lower, upper, friction] = of;
  archive(lower, upper, friction);
}
/// What a program and steps change beside the motion. Factors are made anew.
template <class Archive>
void visit_members(Archive& archive, LinkageState& of) {
  archive(of.motion(), of.force, of.laws, of.gives, of.angle_rules, of.troubles, of.wave_inertia,
          of.wave_inertia_at);
  if (archive.restores()) of.factored = false;
}

}  // namespace plumb::detail
