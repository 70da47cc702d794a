#include "contact/relaxed/relaxed_stepper.hpp"

#include <algorithm>
#include <cmath>

#include "contact/ground/ground_search.hpp"
#include "contact/solved/cluster_limits.hpp"

namespace plumb::detail {
namespace {

/// A blow to hulls is swept on until rods are violated by at most this share.
/// Those of nets that do not fit keep some, and sweeping for long gains little.
constexpr double least_crushed = 1e-3, least_drawn = 1e-2;
/// What a fast capsule strikes is swept on until rods are violated by at most this share, or as they were
/// before. A net opens its meshes no farther then than 5 %.
constexpr double least_torn = 0.1;
/// Where sweeps leave rods violated by more than this share, gradient mid would turn that into speed along
/// them. It takes what particles moved for their velocity then, as in a block (relax.cpp). Gradient new makes
/// speed of it where rods do not fit at all: from sweep to sweep what they lack goes elsewhere.
constexpr double least_guarded = 0.05;
/// A substep in which something is struck, and torn or passed all the same, is cut into at most so many.
constexpr std::uint32_t most_struck_cuts = 32;
/// Substeps have at least so many of the sweeps that they share.
constexpr std::uint32_t least_sweeps = 10;

/// Returns in how many substeps of at most `longest` a time is taken, from 1 to `most`.
std::uint32_t substeps_of(double time, double longest, std::uint32_t most) {
  const double wanted = std::ceil(time / longest);
  return wanted < most ? std::max(1u, static_cast<std::uint32_t>(wanted)) : most;
}

}  // namespace

template <class T>
void RelaxedStepper<T>::step(std::span<LinkageState* const> cluster, const Surroundings& surroundings,
                             const ClusterRules& rules, double dt, Tally& report) {
  nominal_ = dt / rules.substeps;
  leaves_ = rules_.step_sweeps == 0 && !rules.is_watched;
  recovery_rate_ = settings_.recovery * rules.substeps / dt;
  team_ = rules.team;
  is_pressed_ = rules.strain == Strain::pressed;
  const bool is_drawn_net = rules.strain != Strain::none &&
                            std::any_of(cluster.begin(), cluster.end(),
                                        [](const LinkageState* state) { return state->linkage->is_net(); });
  most_crushed_ = is_drawn_net ? least_drawn : least_crushed;
  counts_ = std::any_of(cluster.begin(), cluster.end(),
                        [](const LinkageState* state) { return state->pulls.counts; });
  const double start = cluster.front()->elapsed;
  for (LinkageState* const state : cluster) {
    state->elapsed += dt;
    state->lengths.follow(start);
    state->limit_kept(nominal_);
  }
  ground_.find(surroundings, start);
  gather(cluster, surroundings, dt);
  step_ = dt;
  driving_energy_ = driving_energy(cluster, surroundings);
  const std::uint32_t cuts = contacts_.cuts(crowd_, dt / rules.substeps);
  std::uint32_t substeps = rules.substeps * cuts;
  is_hit_ = cuts > 1 || (contacts_.has_hulls() && is_crushed());
  most_sweeps_ =
      rules_.step_sweeps == 0 ? rules_.stop.sweeps : std::max(least_sweeps, rules_.step_sweeps / substeps);
  const bool may_be_late = report.deadline && cuts == 1;  // what was cut is so that hulls are not crushed
  const double unhurried = may_be_late ? unhurried_substep(cluster) : 0;
  double h = dt / substeps, begin = 0;
  for (std::uint32_t i = 0; i < substeps; ++i) {
    if (const std::uint32_t fewer = substeps_of(dt - (begin + i * h), unhurried, substeps - i);
        may_be_late && fewer < substeps - i && report.is_late()) {
      begin += i * h;
      h = (dt - begin) / fewer;
      substeps = fewer;
      i = 0;
    }
    const double done = begin + i * h;
    if (done > 0 && surroundings.any_moves()) ground_.find(surroundings, start + done);
    advance(cluster, surroundings, {start + done, h, dt - done}, most_struck_cuts, report);
  }
  contacts_.keep(cluster, crowd_);
  scatter(cluster);
}

/// Returns how long a substep (s) may be so that nothing gets far in it for how thick it is. Longer ones are
/// swept on and halved, which takes more time than they save.
template <class T>
double RelaxedStepper<T>::unhurried_substep(std::span<LinkageState* const> cluster) const {
  double fastest = 0, thinnest = INFINITY;
  for (std::uint32_t i = 0; i < cluster.size(); ++i) {
    if (crowd_.is_moving(i)) fastest = std::max(fastest, top_speed(*cluster[i]));
    thinnest = std::min(thinnest, cluster[i]->linkage->thinness());
  }
  return contact_limits::most_approach * thinnest / fastest;
}

/// Moves a cluster through a time, in halves if a blow would tear it or let something pass, down to so many
/// cuts.
template <class T>
void RelaxedStepper<T>::advance(std::span<LinkageState* const> cluster, const Surroundings& surroundings,
                                const Span& span, std::uint32_t cuts, Tally& report) {
  if (substep(cluster, surroundings, span, cuts > 1, report)) return;
  ++report.halvings;
  const double half = 0.5 * span.h;
  advance(cluster, surroundings, {span.start, half, span.left}, cuts / 2, report);
  if (surroundings.any_moves()) ground_.find(surroundings, span.start + half);
  advance(cluster, surroundings, {span.start + half, half, span.left - half}, cuts / 2, report);
}

/// Returns whether a blow has left rods far from their lengths.
template <class T>
bool RelaxedStepper<T>::is_crushed() {
  crowd_.predict(0, Gradient::new_);
  crowd_.prepare(rod_kernels(), false);
  return crowd_.violation(rod_kernels()) > least_crushed;
}

/// Returns the energy of motion (J) of a cluster that is twice as fast all over as what drives it: anchors,
/// winches and ground. With what else it has, that is the most that ground gives by a blow.
template <class T>
double RelaxedStepper<T>::driving_energy(std::span<LinkageState* const> cluster,
                                         const Surroundings& surroundings) const {
  double speed = 0, mass = 0;
  for (std::uint32_t i = 0; i < cluster.size(); ++i) {
    const LinkageState& state = *cluster[i];
    const Linkage& linkage = *state.linkage;
    if (!crowd_.is_moving(i)) continue;
    speed = std::max(speed, state.driving_speed());
    mass += linkage.mass();
    if (!surroundings.any_moves()) continue;
    const Bounds bounds = reach(state, top_speed(state), step_, settings_.margin);
    speed = std::max(speed, surroundings.speed_under(bounds, linkage.filters()));
  }
  return 2 * mass * speed * speed;
}

template <class T>
void RelaxedStepper<T>::scatter(std::span<LinkageState* const> cluster) {
  for (std::uint32_t i = 0; i < cluster.size(); ++i) {
    crowd_.scatter(*cluster[i], i);
    if (!crowd_.is_moving(i)) continue;
    cluster[i]->follow_elastics();
    cluster[i]->elastic_rates.clear();
  }
}

template <class T>
void RelaxedStepper<T>::gather(std::span<LinkageState* const> cluster, const Surroundings& surroundings,
                               double dt) {
  crowd_.gather(cluster, rules_);
  joints_.gather(cluster, crowd_);
  bodies_.gather(cluster, crowd_);
  contacts_.find(cluster, crowd_, surroundings, ground_, dt, recovery_rate_);
}

/// Makes rods as long as they are `t` (s) after the step's start.
template <class T>
void RelaxedStepper<T>::follow_lengths(std::span<LinkageState* const> cluster, double t) {
  if (!crowd_.has_changed_lengths()) return;
  for (LinkageState* const state : cluster) state->lengths.follow(t);
  crowd_.follow_lengths();
}

/// Moves a cluster through a time, unless it may be halved and that is better. Returns whether it did.
template <class T>
bool RelaxedStepper<T>::substep(std::span<LinkageState* const> cluster, const Surroundings& surroundings,
                                const Span& span, bool may_halve, Tally& report) {
  const double h = span.h;
  follow_lengths(cluster, span.start + h);
  crowd_.predict(h, Gradient::new_);
  contacts_.follow(cluster, crowd_, surroundings, ground_, span.left, team_);
  Energies before{.moving = crowd_.kinetic_of_moves(h)};
  // Who is woken moves in this substep, which begins anew then.
  const auto begin_anew = [&] {
    contacts_.keep(cluster, crowd_);
    scatter(cluster);
    gather(cluster, surroundings, span.left);
    return substep(cluster, surroundings, span, may_halve, report);
  };
  if (!contacts_.begin(cluster, crowd_, surroundings, ground_, h, team_)) return begin_anew();
  Gradient gradient = predict(cluster, h);
  begin_rows(cluster, h);
  before.elastic = elastic_energy(cluster);
  solve(gradient, report);
  bool is_missed = false;
  for (int i = 0; contacts_.find_missed(cluster, crowd_, surroundings, ground_, h, team_); ++i) {
    is_missed = i == most_missed;
    if (is_missed) break;
    if (gradient != Gradient::new_) {
      gradient = Gradient::new_;
      crowd_.predict(h, gradient);
      begin_rows(cluster, h);
    }
    solve(gradient, report);
  }
  if (contacts_.wake(cluster)) return begin_anew();
  is_missed = is_missed || is_in_ground_;
  const bool is_torn = is_struck() && (is_missed || crowd_.violation(rod_kernels()) > most_violated());
  if (may_halve && (is_torn || contacts_.outrun_hulls(crowd_))) return false;
  report.missed_contacts += is_missed;
  if (gradient == Gradient::mid && crowd_.violation(rod_kernels()) > least_guarded) {
    gradient = Gradient::new_;
    ++report.mid_guarded;
  }
  crowd_.advance(h, gradient);
  freeze_broken(cluster, report);
  const bool bounces = contacts_.bounce(crowd_);
  brake_joints(cluster, h);
  if (gradient == Gradient::new_) guard_energy(cluster, before, h, bounces, report);
  contacts_.end(cluster, crowd_, h);
  if (leaves_) crowd_.end_keeping(cluster, nominal_);
  count_pulls(cluster, gradient, h);
  report.broken_rods += joints_.end(cluster, crowd_, gradient == Gradient::mid ? 0.5 * h : h);
  report.contact_points = std::max<std::uint64_t>(report.contact_points, contacts_.count_pushes());
  for (std::uint32_t i = 0; i < cluster.size(); ++i)
    if (crowd_.is_moving(i)) cluster[i]->keep_given();
  return true;
}

/// Freezes islands that are not finite where they were, which states still say.
template <class T>
void RelaxedStepper<T>::freeze_broken(std::span<LinkageState* const> cluster, Tally& report) {
  if (crowd_.is_finite()) return;
  for (std::uint32_t i = 0; i < cluster.size(); ++i) {
    if (!crowd_.is_moving(i) || !crowd_.stop_if_broken(*cluster[i], i)) continue;
    cluster[i]->freeze();
    ++report.frozen_islands;
  }
}

/// Predicts by the gradient of a substep, and returns it. What flies gets the blow of what changes its speed;
/// what touches has the new speed by its displacements, and elastics catch a blow themselves.
template <class T>
Gradient RelaxedStepper<T>::predict(std::span<LinkageState* const> cluster, double h) {
  if (!contacts_.is_empty() || joints_.has_elastics()) return Gradient::new_;
  const Gradient gradient = rules_.gradient == Gradient::old ? Gradient::mid : rules_.gradient;
  if (blows_.give(cluster, crowd_, joints_, rules_) || gradient != Gradient::new_)
    crowd_.predict(h, gradient);
  return gradient;
}

/// Returns whether capsules that are fast meet others in the substep, or hold on to them, or hulls are
/// pushed.
template <class T>
bool RelaxedStepper<T>::is_struck() const {
  return contacts_.are_struck() || (contacts_.are_fast() && contacts_.hold_islands()) ||
         (contacts_.has_hulls() && !contacts_.is_empty());
}

/// Returns up to which violation of rods a blow is swept on: no blow made what was there before it. What has
/// no loops has no meshes that open. Rods that do not fit lack more from substep to substep.
template <class T>
double RelaxedStepper<T>::most_violated() const {
  if (is_pressed_ || (!is_hit_ && !crowd_.has_loops())) return INFINITY;
  const double before = crowd_.violation_of_positions();
  if (before > least_torn) return before + least_torn * (1 + before);
  return is_hit_ ? std::max(most_crushed_, before) : least_torn;
}

/// Takes back energy of motion that corrections have given: bounces by single places, what a blow or the
/// momentum of sweeps winds up, rods that do not fit, and what longer substeps have left to shorter ones.
/// What drives gives some, but not to rods that do not fit. What flies keeps its momentum while it is held
/// back.
template <class T>
void RelaxedStepper<T>::guard_energy(std::span<LinkageState* const> cluster, const Energies& before, double h,
                                     bool bounces, Tally& report) {
  const double energy = crowd_.kinetic();
  if (!(energy > before.moving)) return;
  const bool is_strained = crowd_.violation_of_positions() > least_guarded;
  double most = std::max(before.moving, driving_energy_);
  if (!is_strained)
    most = bounces ? before.moving + driving_energy_ + 2 * std::sqrt(before.moving * driving_energy_)
                   : most + h / step_ * driving_energy_;
  if (joints_.has_elastics()) {
    scatter(cluster);
    most += std::max(0.0, before.elastic - elastic_energy(cluster));
  }
  if (!(energy > most)) return;
  ++(energy - most > contact_limits::gained * energy ? report.guarded_energy : report.trimmed_energy);
  typename Crowd<T>::CommonMotion common{};
  if (!contacts_.push_ground()) common = crowd_.common_motion();
  // What flew as one has nothing else to begin with, and most is the energy of that but for rounding.
  const double rest = energy - common.energy;
  crowd_.slow(rest > 0 ? std::sqrt(std::max(0.0, most - common.energy) / rest) : 1, common.velocity);
}

/// Returns what elastics hold (J), with their laws in this substep, where islands are.
template <class T>
double RelaxedStepper<T>::elastic_energy(std::span<LinkageState* const> cluster) const {
  double sum = 0;
  if (joints_.has_elastics())
    for (std::uint32_t i = 0; i < cluster.size(); ++i)
      if (crowd_.is_moving(i)) sum += cluster[i]->elastic_energy();
  return sum;
}

template <class T>
void RelaxedStepper<T>::count_pulls(std::span<LinkageState* const> cluster, Gradient gradient, double h) {
  if (!counts_) return;
  const bool wind = crowd_.has_changed_lengths();
  for (LinkageState* const state : cluster)
    if (wind && state->pulls.counts) state->lengths.begin_pulls(state->pulls.rods);
  crowd_.count_pulls(h, gradient, cluster);
  for (LinkageState* const state : cluster)
    if (wind && state->pulls.counts) state->lengths.end_pulls(state->pulls.rods);
}

template <class T>
void RelaxedStepper<T>::begin_rows(std::span<LinkageState* const> cluster, double h) {
  crowd_.prepare(rod_kernels(), counts_);
  if (leaves_) crowd_.keep_violations(nominal_);
  if (!joints_.are_empty()) scatter(cluster);
  joints_.begin(cluster, crowd_, h, recovery_rate_);
}

template <class T>
void RelaxedStepper<T>::brake_joints(std::span<LinkageState* const> cluster, double h) {
  for (std::uint32_t i = 0; i < cluster.size(); ++i) {
    LinkageState& state = *cluster[i];
    if (state.linkage->joint_drag() == 0 || !crowd_.is_moving(i)) continue;
    crowd_.scatter(state, i);
    state.linkage->brake_joints(h, state.x, state.v, rigid_);
    crowd_.gather_velocities(state, i);
  }
}

template class RelaxedStepper<float>;
template class RelaxedStepper<double>;

}  // namespace plumb::detail
