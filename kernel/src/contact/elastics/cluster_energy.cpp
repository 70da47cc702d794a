// This file sees to it that elastics give no more energy than they took.

#include <algorithm>
#include <cmath>
#include <utility>

#include "contact/solved/cluster_limits.hpp"
#include "contact/solved/cluster_stepper.hpp"
#include "reference/multipliers/small_matrices.hpp"

namespace plumb::detail {
using namespace contact_limits;

/// Returns what elastics hold where the islands are now, J.
double ClusterStepper::elastic_energy() const {
  double sum = 0;
  for (std::uint32_t i = 0; i < count_; ++i)
    if (islands_[i].awake) sum += islands_[i].state->elastic_energy();
  return sum;
}

/// Returns what pulls of constraints do where anchors move and rods change their length, `at` (s) in the
/// step, in J times the unit of time in which they are impulses.
double ClusterStepper::work_of_given(Array<double> Island::*pulls, double at) {
  double sum = 0;
  for (std::uint32_t i = 0; i < count_; ++i) {
    Island& island = islands_[i];
    if (!island.awake || island.theta != 0 || !island.state->is_driven()) continue;
    island.state->lengths.follow(at);
    sum += island.state->work_of_given(island.*pulls, island.unknowns);
    island.state->lengths.follow(now_ + island.h);
  }
  return sum;
}

double ClusterStepper::work_of_common(double h) {
  double sum = 0;
  for (std::uint32_t i = 0; i < count_; ++i)
    if (islands_[i].awake && islands_[i].state->is_driven())
      sum += islands_[i].state->work_of_common(islands_[i].v, h);
  return sum;
}

/// Returns the energy of elastics where a substep starts, alone and with that of its velocities. Clusters
/// that hold none are not measured.
ClusterStepper::Energies ClusterStepper::energies_of_elastics() const {
  if (std::none_of(islands_.begin(), islands_.begin() + count_,
                   [](const Island& each) { return each.state->trades_energy(); }))
    return {};
  const double elastic = elastic_energy();
  return {elastic, elastic + kinetic()};
}

/// Returns the energy of motion where a substep starts, J.
double ClusterStepper::kinetic() const {
  double sum = 0;
  for (std::uint32_t i = 0; i < count_; ++i)
    if (islands_[i].awake) sum += islands_[i].state->linkage->kinetic(islands_[i].state->v);
  return sum;
}

/// Returns the energy of motion and that of weight and constant forces where a substep ends, J.
std::pair<double, double> ClusterStepper::kinetic_and_potential() const {
  double kinetic = 0, potential = 0;
  for (std::uint32_t i = 0; i < count_; ++i) {
    if (!islands_[i].awake) continue;
    const LinkageState& state = *islands_[i].state;
    kinetic += state.linkage->kinetic(islands_[i].v);
    potential += state.linkage->potential(state.x, state.force);
  }
  return {kinetic, potential};
}

/// Returns the energy that lifts all by its size, J.
double ClusterStepper::weight() const {
  double sum = 0;
  for (std::uint32_t i = 0; i < count_; ++i)
    if (islands_[i].awake) sum += islands_[i].pull() * islands_[i].state->linkage->size();
  return sum;
}

/// Returns whether elastics hold energy, and nothing gives any but they, weight and constant forces.
bool ClusterStepper::is_passive() const {
  bool any = false;
  for (std::uint32_t i = 0; i < count_; ++i) {
    const LinkageState& state = *islands_[i].state;
    if (!islands_[i].awake) continue;
    const auto anchors = std::span(state.v).subspan(state.linkage->movable());
    if (state.linkage->has_air() || state.lengths.move() ||
        std::any_of(anchors.begin(), anchors.end(), [](Vec3 v) { return v != Vec3{}; }))
      return false;
    any = any || state.trades_energy();
  }
  return any;
}

/// Puts positions back to where the substep started.
void ClusterStepper::take_back() {
  for (std::uint32_t i = 0; i < count_; ++i) {
    Island& island = islands_[i];
    if (!island.awake) continue;
    std::swap(island.state->x, island.there);
    island.state->factored = false;
  }
}

/// Makes room for a substep with gradient new, so that the first one allocates nothing.
void ClusterStepper::make_room_to_damp(Island& island) {
  const std::uint32_t movable = island.state->linkage->movable();
  for (Array<Vec3>* const each : {&island.at, &island.along}) each->reserve(island.state->x.size());
  for (Array<Vec3>* const each : {&island.bent, &island.lag, &island.rigid}) each->reserve(movable);
  for (Array<double>* const each : {&island.pulls, &island.end_pulls})
    each->reserve(island.state->linkage->constraints() + island.state->laws.size());
}

namespace {

/// Returns the momentum (kg m/s) of islands that move in this way, and the angular one about `center`.
std::pair<Vec3, Vec3> momenta(std::span<ClusterIsland> islands, Array<Vec3> ClusterIsland::*motion,
                              Vec3 center) {
  Vec3 linear{}, angular{};
  for (ClusterIsland& island : islands) {
    island.impulse.resize(island.state->linkage->movable());
    island.state->linkage->momenta(island.*motion, island.impulse);
    for (std::size_t k = 0; k < island.impulse.size(); ++k) {
      linear += island.impulse[k];
      angular += cross(island.state->x[k] - center, island.impulse[k]);
    }
  }
  return {linear, angular};
}

}  // namespace

/// Returns whether nothing takes momentum from what is awake: nothing is fixed, sleeps or is pushed by
/// ground.
bool ClusterStepper::flies() const {
  return std::all_of(islands_.begin(), islands_.begin() + count_,
                     [](const Island& each) {
                       return each.awake && !each.state->linkage->is_grounded() && each.ground.is_empty();
                     }) &&
         std::none_of(rows_.begin(), rows_.end(), [](const Row& row) {
           return row.kind == Kind::normal && row.ends == 1 && (row.p != 0 || row.q != 0);
         });
}

/// Finds what all would do as one rigid thing, with the momentum and the angular momentum of Island::v. Where
/// something takes momentum that is nothing.
void ClusterStepper::find_common_motion() {
  const std::span<Island> all(islands_.data(), count_);
  const auto move = [&](auto&& motion) {
    for (Island& each : all) {
      each.rigid.resize(each.state->linkage->movable());
      std::transform(each.state->x.begin(), each.state->x.begin() + each.rigid.size(), each.rigid.begin(),
                     motion);
    }
  };
  move([](Vec3) { return Vec3{}; });
  if (!flies()) return;
  double mass = 0;
  for (const Island& each : all) mass += each.state->linkage->mass();
  move([](Vec3 x) { return x; });
  const Vec3 center = (1 / mass) * momenta(all, &Island::rigid, {}).first;
  const auto [linear, angular] = momenta(all, &Island::v, center);
  const auto turning = [&](Vec3 axis) {
    move([&](Vec3 x) { return cross(axis, x - center); });
    return momenta(all, &Island::rigid, center).second;
  };
  const Vec3 x = turning({1, 0, 0}), y = turning({0, 1, 0}), z = turning({0, 0, 1});
  const Vec3 turns = spin_of({x.x, x.y, x.z, y.y, y.z, z.z}, angular);
  const Vec3 velocity = (1 / mass) * linear, spin = is_finite(turns) ? turns : Vec3{};
  if (!is_finite(velocity)) return move([](Vec3) { return Vec3{}; });
  move([&](Vec3 at) { return velocity + cross(spin, at - center); });
}

/// Takes energy (J) from islands that are no faster than what sweeps leave of them, as far as they have it.
/// Only weight counts for that: where it is small, what is faster than it makes things is no tremor.
void ClusterStepper::slow_trembling(double excess) {
  const auto for_trembling = [&](auto&& f) {
    for (std::uint32_t i = 0; i < count_; ++i) {
      Island& island = islands_[i];
      if (!island.awake) continue;
      const Linkage& linkage = *island.state->linkage;
      const double by_weight = 0.5 * island.h * norm(linkage.gravity());  // m/s
      const double most = trembling * left_by_sweeps * tighter * settings_.sweep_tolerance * by_weight;
      const std::span<Vec3> v = std::span(island.v).first(linkage.movable());
      if (std::all_of(v.begin(), v.end(), [&](Vec3 each) { return dot(each, each) <= most * most; }))
        f(linkage, v);
    }
  };
  double in_tremor = 0;  // J
  for_trembling([&](const Linkage& linkage, std::span<const Vec3> v) { in_tremor += linkage.kinetic(v); });
  const double by = in_tremor > excess ? std::sqrt(1 - excess / in_tremor) : 0;
  for_trembling([&](const Linkage&, std::span<Vec3> v) {
    for (Vec3& each : v) each = by * each;
  });
}

/// Takes energy from the motion that is not a rigid whole's or, if that has less, from all that is kinetic,
/// J.
void ClusterStepper::slow_down(double excess, double kinetic) {
  const double loose = find_rigid_motion();
  if (excess <= loose) return scale_loose_motion(std::sqrt(1 - excess / loose));
  slow_all(excess, kinetic);
}

/// Returns whether a substep may stand, as it is or with less motion. Its velocities are still apart, in
/// Island::v. What may not stand is taken again with gradient new, then shorter, and slowed down in the end.
///
/// A frozen secant, and springs that turn fast, keep energy only as far as substeps resolve them. Alone in
/// the air an island is compared with the least that it had, since gains may be small and many. Else it is
/// compared with what it had before the substep.
bool ClusterStepper::guard_elastics(const Energies& before, bool touched, bool can_shorten, Tally& report) {
  const bool is_kept = is_passive(), is_alone = is_kept && count_ == 1 && !touched;
  for (std::uint32_t i = 0; i < count_ && !is_alone; ++i)
    if (islands_[i].state->trades_energy()) islands_[i].state->energy.reset();
  if (!is_kept) return true;
  const auto [kinetic, potential] = kinetic_and_potential();
  const double elastic = elastic_energy(), moving = kinetic + elastic, now = moving + potential;
  LinkageState& first = *islands_[0].state;
  if (is_alone && !first.energy) {
    first.energy = before.all;
    first.most_motion = before.moving;
  }
  const double wanted = is_alone ? *first.energy : before.all;
  const double scale = std::max(is_alone ? first.most_motion : before.moving, moving);
  const double most = wanted + most_gained * scale + (touched ? gained : unnoticed) * weight();
  if (now > most && now > before.all) {
    if (!takes_end_ || can_shorten) return false;
    slow_down(now - wanted, kinetic);
  }
  if (takes_end_) ++report.guarded_energy;
  if (is_alone) {
    first.energy = std::min(wanted, now);
    first.most_motion = scale;
  }
  return true;
}

/// Returns the energy of motion (J) of all that is awake at twice the speed of what drives it.
double ClusterStepper::driving_energy(const Surroundings& surroundings) const {
  double speed = 0, mass = 0;
  for (std::uint32_t i = 0; i < count_; ++i) {
    const LinkageState& state = *islands_[i].state;
    if (!islands_[i].awake) continue;
    mass += state.linkage->mass();
    speed = std::max(speed, state.driving_speed());
    if (surroundings.any_moves())
      speed = std::max(speed, surroundings.speed_under(islands_[i].bounds, state.linkage->filters()));
  }
  return 2 * mass * speed * speed;
}

/// Returns whether a substep may stand where something drives, which gives no more than a blow that bounces.
/// What it squeezes, against an anchor, say, would be thrown at any speed. `before` (J) is all energy where
/// the substep started.
bool ClusterStepper::guard_driven(double before, const Surroundings& surroundings, bool can_shorten) {
  const bool drives =
      surroundings.any_moves() || std::any_of(islands_.begin(), islands_.begin() + count_,
                                              [](const Island& each) { return each.state->is_driven(); });
  if (!drives) return true;
  const auto [now, potential] = kinetic_and_potential();
  const double then = kinetic();
  if (!(now > then)) return true;
  const double driving = driving_energy(surroundings);
  if (driving == 0) return true;
  const double released = std::max(0.0, before - then - potential - elastic_energy());
  const double most = then + driving + 2 * std::sqrt(then * driving) + released + gained * weight();
  is_squeezed_ = now > most && !can_shorten;
  return now <= most;
}

/// Takes back what a relaxed step has gained above the energy of before_: to bring rods to their lengths
/// turns strain into motion.
void ClusterStepper::hold_energy(Tally& report) {
  double before = 0;
  for (std::uint32_t i = 0; i < count_; ++i) {
    Island& island = islands_[i];
    if (!island.awake) continue;
    const LinkageState& state = *island.state;
    before += state.linkage->kinetic(before_[i].v) + state.linkage->potential(before_[i].x, state.force);
    island.v = state.v;
    island.theta = 0;
  }
  guard_energy(before, 0, true, false, report);
  for (std::uint32_t i = 0; i < count_; ++i)
    if (islands_[i].awake) islands_[i].state->v = islands_[i].v;
}

/// Returns whether a substep may stand, as it is or with less motion. `before` (J) has what was given since
/// it started, and `held` what elastics held then.
bool ClusterStepper::guard(double before, const Energies& held, bool touched, bool can_shorten,
                           Tally& report) {
  const double recovered = touched ? work_of_recovery() : 0;
  if (!guard_energy(before, recovered, touched, can_shorten && !(rests_ && is_stopped_), report)) {
    // What the sweeps left may have lifted something, so tighter sweeps are tried before a shorter substep.
    tries_again_ = touched && !tight_;
    tight_ = true;
    return false;
  }
  if (!guard_elastics({before + held.all, held.moving}, touched, can_shorten, report)) {
    tries_again_ = !takes_end_;
    takes_end_ = true;
    return false;
  }
  return true;
}

}  // namespace plumb::detail
