// This file says what is tried with a substep that is not solved at once.

#include <algorithm>
#include <cmath>
#include <utility>

#include "contact/linkage/linkage_bounds.hpp"
#include "contact/rows.hpp"
#include "contact/solved/cluster_limits.hpp"
#include "contact/solved/cluster_stepper.hpp"

namespace plumb::detail {
using namespace contact_limits;

namespace {

/// Returns whether a cluster is one line of rods. Alone it is no crowd, however often it cannot be solved.
bool is_line(std::span<LinkageState* const> cluster) {
  constexpr std::uint32_t of_line = 2;  // colours of rods, where none has two at an end
  const Linkage& linkage = *cluster.front()->linkage;
  return cluster.size() == 1 && linkage.rods() < linkage.particles() && linkage.colored().colors() <= of_line;
}

/// Returns whether islands touch each other, or what has loops touches anything, in many places, or could not
/// be solved of late.
bool is_crowd(std::span<LinkageState* const> cluster) {
  std::size_t touching = 0;
  for (const LinkageState* const state : cluster) {
    if (state->relax_for > 0 && !is_line(cluster)) return true;
    const bool has_loops = state->linkage->has_loops();
    for (const KeptContact& each : state->kept)
      touching += has_loops ? kind_of(each.key) != KeyKind::angle : kind_of(each.key) == KeyKind::island;
  }
  return touching > few_touching;
}

/// Returns whether a line between anchors is among what touches. What lies on it draws it taut, and sweeps
/// carry such a pull along few rods: it would give way, and come back through what lies on it.
bool has_line_between_anchors(std::span<LinkageState* const> cluster) {
  return std::any_of(cluster.begin(), cluster.end(), [](const LinkageState* state) {
    return state->linkage->anchors() > 1 && !state->linkage->has_loops();
  });
}

/// Returns how rods of a cluster did not fit when they were looked at last.
Strain strain_of(std::span<LinkageState* const> cluster) {
  Strain out = Strain::none;
  for (const LinkageState* const state : cluster) out = std::max(out, state->strain);
  return out;
}

/// Returns whether some rods break, hang slack or give. Solved with what they touch, they take far longer
/// than rigid ones.
bool gives(std::span<LinkageState* const> cluster) {
  return std::any_of(cluster.begin(), cluster.end(),
                     [](const LinkageState* state) { return !state->laws.empty(); });
}

/// Returns whether some island has springs, or what is as soft.
bool have_springs(std::span<LinkageState* const> cluster) {
  return std::any_of(cluster.begin(), cluster.end(),
                     [](const LinkageState* state) { return state->trades_energy(); });
}

/// Returns whether some island is one particle.
bool has_balls(std::span<LinkageState* const> cluster) {
  return std::any_of(cluster.begin(), cluster.end(),
                     [](const LinkageState* state) { return state->linkage->movable() == 1; });
}

/// Returns whether ground may move what it touches.
bool is_on_moving(std::span<LinkageState* const> cluster, const Surroundings& surroundings) {
  return std::any_of(cluster.begin(), cluster.end(), [&](const LinkageState* state) {
    const Bounds around = bounds_of(*state->linkage, state->x, state->linkage->size());
    return surroundings.move_under(around, state->linkage->filters());
  });
}

/// Returns the thinness (m) of the thinnest thing.
double thinness(std::span<LinkageState* const> cluster) {
  double out = INFINITY;
  for (const LinkageState* const state : cluster) out = std::min(out, state->linkage->thinness());
  return out;
}

/// Returns whether relaxation for h (s) brought something farther from where it was than it goes, or the
/// island is wide. Sweeps over what anchors pull apart, or into ground, need not end anywhere.
bool has_run_away(const LinkageState& state, const LinkageMotion& before, double h) {
  double fastest = state.lengths.speed();
  for (const std::span<const Vec3> velocities : {std::span(state.v), std::span(before.v)})
    for (const Vec3 v : velocities) {
      if (!is_finite(v)) return true;
      fastest = std::max(fastest, norm(v));
    }
  Bounds wide = nowhere;
  for (const Vec3 x : before.x) include(wide, x, state.linkage->size());
  const double most = norm(wide.high - wide.low) + 2 * h * (fastest + h * norm(state.linkage->gravity()));
  for (std::size_t k = 0; k < state.x.size(); ++k)
    if (!(norm(state.x[k] - before.x[k]) <= most)) return true;
  return false;
}

}  // namespace

/// Solves a substep of h (s), or one that is shorter but hardly than `least`. It is tried whole, halved
/// twice, with a loose grip, and relaxed. Then it is tried whole again, with ground that is swept and with
/// overlaps that yield to each other, and at last halved on. Where rods do not fit, as those of a net in a
/// box, or heavy balls would sink through what yields, all that is left of the step is relaxed. Returns its
/// length. It is 0 if nothing was found: what cannot be solved stays where it is, and keeps what motion is
/// common.
double ClusterStepper::solve(std::span<LinkageState* const> cluster, const Surroundings& surroundings,
                             double h, double least, Tally& report) {
  const double whole = h;
  loose_ = sweeps_ground_ = takes_end_ = sinks_ = in_crowd_ = false;
  strain_ = Strain::none;
  kept_of_overlaps_ = 1;
  bool was_loose = false;
  const bool is_lone = is_line(cluster), is_watched = gives(cluster) && has_balls(cluster);
  if (is_watched) keep_motion(cluster);
  double halved = h, in_vain = 0;  // s
  while (!substep(surroundings, h, report)) {
    if (std::exchange(is_squeezed_, false)) return solve_strained(cluster, surroundings, report);
    if (found_crowd_) {
      may_sink_ = may_strain_ = true;
      in_crowd_ = gives(cluster);
      if (relax(cluster, surroundings, 1, h, report)) return h;
      looks_for_crowd_ = in_crowd_ = false;
      continue;
    }
    if (std::exchange(tries_again_, false)) continue;
    if (std::exchange(buckles_, false)) {
      buckle(cluster, surroundings);
      continue;
    }
    if (h == whole && !was_loose) find_overload();
    if (!was_loose && is_on_ground() && (h <= few_cuts * whole || is_landing())) {
      loose_ = was_loose = true;
      ++report.fallbacks;
      halved = std::exchange(h, whole);
      continue;
    }
    // Halving goes on from where it was.
    h = (std::exchange(loose_, false) ? halved : h) / 2;
    ++report.halvings;
    if (++halvings_ > most_if_pressed && overload_.state == nullptr && is_on_moving(cluster, surroundings))
      strain_ = Strain::pressed;
    const auto lacks_room = [&] { return (has_nets_ && in_vain == whole) || will_come_taut(); };
    if (strain_ == Strain::pressed || (h < shortest_ && overload_.state == nullptr && lacks_room()))
      return solve_strained(cluster, surroundings, report);
    // What would sink into ground, or be torn, is relaxed for a shorter time, in which it goes less far.
    may_sink_ = !is_lone || h < std::max(least_sunk * whole, least / 16);
    gives_way_ = gives_way_ || h < few_cuts_of_nets * whole || halvings_ > most_halvings_of_nets;
    may_strain_ = !has_nets_ || gives_way_;
    const double relaxed = sinks_ ? h : whole;
    if (h < few_cuts * whole && relax_stuck(cluster, surroundings, relaxed, in_vain, report)) return relaxed;
    if (h < few_cuts * whole && try_otherwise(report)) {
      h = whole;
      continue;
    }
    if (h >= least / 16) continue;
    if (!break_overload(report) && !fit(cluster, surroundings))
      return solve_strained(cluster, surroundings, report);
    in_vain = 0;
    h = whole;
  }
  if (!is_watched || kept_of_overlaps_ == 1 || !has_ball_sunk(most_approach * thinness(cluster))) return h;
  return_to_motion(cluster);
  return solve_strained(cluster, surroundings, report);
}

/// Relaxes a substep of h (s) that halving does not help, with the bodies that touch nets. Returns false, and
/// nothing has moved, if it cannot be relaxed either. `vain` is a length (s) for which that is known.
bool ClusterStepper::relax_stuck(std::span<LinkageState* const> cluster, const Surroundings& where, double h,
                                 double& vain, Tally& report) {
  if (h == vain || overload_.state != nullptr || !any_touch() || any_bends()) return false;
  if (!std::all_of(cluster.begin(), cluster.end(),
                   [&](const LinkageState* each) { return can_relax(*each, h, has_nets_); }))
    return false;
  if (!relax(cluster, where, 1, h, report, has_nets_)) {
    if (may_sink_ && may_strain_) vain = h;
    return false;
  }
  ++report.fallbacks;
  for (LinkageState* const state : cluster) state->relax_for = is_line(cluster) ? 0 : patience;
  return true;
}

/// Returns whether anchors that move leave some rods no place until the end of the step. What they hold gets
/// as fast as they come near that as shorter substeps let it, and throws what touches it. That is looked at
/// once in a step.
bool ClusterStepper::will_come_taut() {
  if (std::exchange(has_looked_ahead_, true)) return false;
  projection_.holds.clear();
  bool fits = true;
  for (std::uint32_t i = 0; i < count_ && fits; ++i) {
    LinkageState& state = *islands_[i].state;
    if (!islands_[i].awake || !state.is_driven()) continue;
    islands_[i].there = state.x;
    for (std::size_t k = state.linkage->movable(); k < state.x.size(); ++k) state.x[k] += left_ * state.v[k];
    state.lengths.follow(now_ + left_);
    fits = project_positions(state, projection_) == 0;
    state.x = islands_[i].there;
    state.lengths.follow(now_);
    state.factored = false;
  }
  return !fits;
}

/// Relaxes what is left of the step, in which rods may keep what they lack, where some do not fit. What hangs
/// on anchors has come taut then, without a bounce: just before it is fast without going anywhere. The
/// others' velocities are how far they went, unless that is faster than they were and than relaxation lets
/// them be: what overlaps is pushed apart in however little time. Returns that time (s), or 0 if it cannot be
/// relaxed: all stays where it is then.
double ClusterStepper::solve_strained(std::span<LinkageState* const> cluster, const Surroundings& where,
                                      Tally& report) {
  strain_ = std::max(strain_, Strain::drawn);
  may_sink_ = may_strain_ = true;
  for (std::uint32_t i = 0; i < count_; ++i)
    if (LinkageState& state = *islands_[i].state; islands_[i].awake && state.linkage->is_grounded())
      std::fill_n(state.v.begin(), state.linkage->movable(), Vec3{});
  if (!relax(cluster, where, 1, left_, report)) {
    ++report.unsolved;
    stop();
    return 0;
  }
  ++report.fallbacks;
  for (std::uint32_t i = 0; i < count_; ++i) islands_[i].state->relax_for = patience;
  take_displacements();
  return left_;
}

/// Lets what flies be as fast as it went in what was left of the step, if all of that has no more energy than
/// it had, or than relaxation gave it. Some islands alone would not keep the momentum of all.
void ClusterStepper::take_displacements() {
  const auto for_flying = [&](auto&& f) {
    for (std::uint32_t i = 0; i < count_; ++i)
      if (LinkageState& state = *islands_[i].state; islands_[i].awake && !state.linkage->is_grounded())
        f(state, islands_[i].v, before_[i]);
  };
  double as_it_went = 0, before_all = 0, relaxed = 0;  // J
  for_flying([&](const LinkageState& state, Array<Vec3>& by, const auto& before) {
    by.resize(state.linkage->movable());
    for (std::uint32_t k = 0; k < by.size(); ++k) by[k] = (1 / left_) * (state.x[k] - before.x[k]);
    as_it_went += state.linkage->kinetic(by);
    before_all += state.linkage->kinetic(before.v);
    relaxed += state.linkage->kinetic(state.v);
  });
  if (!(as_it_went <= std::max(before_all, relaxed))) return;
  for_flying([](LinkageState& state, const Array<Vec3>& by, const auto&) {
    std::copy(by.begin(), by.end(), state.v.begin());
  });
}

/// Changes how what halving did not help is solved, if there is another way. Returns whether there is.
bool ClusterStepper::try_otherwise(Tally& report) {
  // Pushes that go round in a circle in the matrix are found one after the other.
  if (!sweeps_ground_ && is_on_ground()) return sweeps_ground_ = true;
  const bool any_overlap =
      std::any_of(rows_.begin(), rows_.end(), [](const Row& row) { return row.gap < 0; });
  if (!is_unfound_ || kept_of_overlaps_ < 1 || !any_overlap) return false;
  kept_of_overlaps_ = yielding;
  ++report.fallbacks;
  return true;
}

/// Takes all motion but what is common to all that is awake: what flies keeps its momenta.
void ClusterStepper::stop() {
  for (std::uint32_t i = 0; i < count_; ++i) islands_[i].v = islands_[i].state->v;
  find_common_motion();
  for (std::uint32_t i = 0; i < count_; ++i)
    if (const Island& each = islands_[i]; each.awake)
      std::copy(each.rigid.begin(), each.rigid.end(), each.state->v.begin());
}

bool ClusterStepper::is_on_ground() const {
  return std::any_of(islands_.begin(), islands_.begin() + count_,
                     [](const Island& each) { return !each.ground.is_empty(); });
}

/// Returns whether any island has bends, which a blow along them makes stiffer than what few sweeps solve.
bool ClusterStepper::any_bends() const {
  return std::any_of(islands_.begin(), islands_.begin() + count_,
                     [](const Island& each) { return !each.state->linkage->bends().empty(); });
}

/// Returns whether most of what touches ground did not do so a substep ago.
bool ClusterStepper::is_landing() const {
  std::size_t all = 0, held = 0;
  for (std::uint32_t i = 0; i < count_; ++i)
    islands_[i].ground.for_all([&](const GroundContact& each) {
      ++all;
      held += each.is_held;
    });
  return 2 * held < all;
}

/// Returns whether anything touches in this substep.
bool ClusterStepper::any_touch() const {
  return is_on_ground() ||
         std::any_of(rows_.begin(), rows_.end(), [](const Row& row) { return row.kind == Kind::normal; });
}

/// Relaxes a step of a crowd, or of what has rods that do not fit. Returns false, and nothing has moved, if
/// it is none or cannot be relaxed.
bool ClusterStepper::relax_crowd(std::span<LinkageState* const> cluster, const Surroundings& surroundings,
                                 std::uint32_t substeps, double dt, Tally& report) {
  strain_ = strain_of(cluster);
  const bool may_be_crowd = relaxes_crowds_ && !has_line_between_anchors(cluster);
  const bool relaxes = strain_ != Strain::none || (may_be_crowd && is_crowd(cluster));
  looks_for_crowd_ = may_be_crowd && !relaxes;
  for (LinkageState* const state : cluster) state->relax_for -= state->relax_for > 0;
  may_sink_ = may_strain_ = true;
  in_crowd_ = gives(cluster);
  return relaxes && relax(cluster, surroundings, substeps, dt, report);
}

/// Returns in how many substeps a step of dt (s) is relaxed: what is fast or thin takes more.
std::uint32_t ClusterStepper::relaxed_substeps(double dt) const {
  double fastest = 0, thinnest = INFINITY;
  for (std::uint32_t i = 0; i < count_; ++i) {
    if (islands_[i].awake) fastest = std::max(fastest, top_speed(*islands_[i].state));
    thinnest = std::min(thinnest, islands_[i].state->linkage->thinness());
  }
  const double wanted = std::ceil(dt * fastest / (most_approach * thinnest));
  return static_cast<std::uint32_t>(
      std::clamp(wanted, static_cast<double>(few_relaxed), static_cast<double>(most_relaxed)));
}

void ClusterStepper::keep_motion(std::span<LinkageState* const> cluster) {
  if (before_.size() < cluster.size()) before_.resize(cluster.size());
  for (std::size_t i = 0; i < cluster.size(); ++i) {
    cluster[i]->lengths.follow(now_);  // A substep that failed has made rods as long as at its end.
    before_[i] = cluster[i]->motion();
  }
}

void ClusterStepper::return_to_motion(std::span<LinkageState* const> cluster) {
  for (std::size_t i = 0; i < cluster.size(); ++i) {
    cluster[i]->return_to(before_[i]);
    islands_[i].awake = !cluster[i]->asleep && !cluster[i]->frozen;
  }
}

bool ClusterStepper::can_relax(const LinkageState& state, double dt, bool with_bodies) const {
  const Linkage& linkage = *state.linkage;
  return relaxed_ &&
         (strain_ != Strain::none || with_bodies ? linkage.can_relax() : linkage.relaxes_well(in_crowd_)) &&
         throw_of(state, dt) <= farthest_throw * linkage.size();
}

/// Relaxes a step of dt (s), and brings rods to their lengths after it. Bodies are relaxed where rods do not
/// fit, or if that is asked for. Returns false, and nothing has moved, if some island cannot be relaxed or
/// its rods are too far from their lengths.
bool ClusterStepper::relax(std::span<LinkageState* const> cluster, const Surroundings& surroundings,
                           std::uint32_t substeps, double dt, Tally& report, bool with_bodies) {
  if (!std::all_of(cluster.begin(), cluster.end(),
                   [&](const LinkageState* each) { return can_relax(*each, dt, with_bodies); }))
    return false;
  keep_motion(cluster);
  Tally tried = report;
  ClusterRules rules{.substeps = std::max(substeps, relaxed_substeps(dt)), .team = team_, .strain = strain_};
  const double elapsed = cluster.front()->elapsed;
  for (LinkageState* const state : cluster) state->elapsed = now_;
  // Where rods do not fit pushes would grow without bound. None is kept for the next substep. Springs fit.
  const bool forgets = strain_ != Strain::none && !have_springs(cluster);
  const std::uint32_t parts = forgets ? std::exchange(rules.substeps, 1) : 1;
  for (std::uint32_t i = 0; i < parts; ++i) {
    for (LinkageState* const state : cluster)
      if (forgets) state->kept.clear();
    relaxed_->step(cluster, surroundings, rules, dt / parts, tried);
  }
  ground_.find(surroundings, now_ + dt);
  gives_up_missed_ = false;
  bool fits = true;
  for (std::size_t i = 0; i < cluster.size(); ++i) fits = fits && !has_run_away(*cluster[i], before_[i], dt);
  fits = fits && bring_to_lengths(surroundings);
  const bool sinks = !may_sink_ && (!fits || (gives_up_missed_ && have_sunk(dt)));
  sinks_ = sinks_ || sinks;
  const bool sinks_ball = fits && has_ball_sunk(settings_.slop);
  if (sinks_ball && strain_ != Strain::none) keep_strain();
  if (fits && !sinks && (strain_ != Strain::none || !sinks_ball)) {
    for (LinkageState* const state : cluster) {
      state->forget_tautness();
      state->is_relaxed = true;
      state->is_pushed_out = false;
      state->elapsed = std::max(elapsed, now_ + dt);
    }
    report = tried;
    report.elastic_substeps += strain_of(cluster) != Strain::none;
    report.missed_contacts += gives_up_missed_;
    if (!surroundings.any_moves()) hold_energy(report);
    return true;
  }
  report.block_sweeps = tried.block_sweeps;
  return_to_motion(cluster);
  ground_.find(surroundings, now_);
  return false;
}

}  // namespace plumb::detail
