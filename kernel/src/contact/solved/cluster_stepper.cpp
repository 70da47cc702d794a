#include "contact/solved/cluster_stepper.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include "contact/linkage/linkage_bounds.hpp"
#include "contact/solved/cluster_limits.hpp"

namespace plumb::detail {
using namespace contact_limits;

namespace {

bool is_finite(const LinkageState& state) {
  const auto all = [](std::span<const Vec3> of) {
    return std::all_of(of.begin(), of.end(), [](Vec3 v) { return plumb::is_finite(v); });
  };
  return all(state.x) && all(state.v);
}

}  // namespace

ContactSettings scaled(ContactSettings settings) {
  for (double* const each :
       {&settings.margin, &settings.slop, &settings.bounce_speed, &settings.tolerance, &settings.sleep_speed})
    *each *= settings.length_scale;
  return settings;
}

double throw_of(const LinkageState& state, double dt) {
  double pull = 0;
  for (const Vec3 force : state.force) pull += norm(force);
  return 0.5 * pull / state.linkage->mass() * dt * dt;
}

Bounds reach(const LinkageState& state, double speed, double dt, double margin) {
  // A force that throws it too far would only join others into a cluster that cannot be solved.
  const double thrown = throw_of(state, dt);
  double fall = thrown > farthest_throw * state.linkage->size() ? 0 : thrown;
  fall += 0.5 * norm(state.linkage->gravity()) * dt * dt + state.throw_by_elastics(dt);
  return bounds_of(*state.linkage, state.x, 1.1 * speed * dt + fall + margin);
}

void ClusterStepper::step(std::span<LinkageState* const> cluster, const Surroundings& surroundings,
                          const ClusterRules& rules, double dt, Tally& report) {
  const std::uint32_t substeps = rules.substeps;
  team_ = rules.team;
  surroundings_ = &surroundings;
  count_ = static_cast<std::uint32_t>(cluster.size());
  if (islands_.size() < count_) islands_.resize(count_);
  has_nets_ = false;
  for (std::uint32_t i = 0; i < count_; ++i) {
    islands_[i].state = cluster[i];
    has_nets_ = has_nets_ || cluster[i]->linkage->is_net();
    islands_[i].awake = !cluster[i]->asleep && !cluster[i]->frozen;
    islands_[i].theta = 0;
    islands_[i].ground.clear();
  }
  rows_.clear();  // Those of another cluster, or of another step, are none of this one's.
  for (LinkageState* const state : cluster) state->is_relaxed = state->is_pushed_out = false;
  now_ = cluster.front()->elapsed;
  if (relax_crowd(cluster, surroundings, substeps, dt, report)) return;
  left_ = dt;
  shortest_ = dt / most_guards;
  shortest_if_missed_ = dt / most_missed_cuts;
  recovery_rate_ = settings_.recovery * substeps / dt;
  halvings_ = 0;
  tight_ = is_fitted_ = is_buckled_ = is_stopped_ = is_squeezed_ = has_looked_ahead_ = gives_way_ = false;
  bool may_fly = rules.time_order > 2 && count_ == 1 && islands_[0].awake && !cluster[0]->lengths.move();
  const double start = cluster.front()->elapsed;
  for (LinkageState* const state : cluster) state->elapsed += dt;
  double likely = dt;  // a substep of this length is likely to be solved
  while (left_ > 1e-12 * dt) {
    const double in_flight = rules.is_watched ? most_turn_if_watched : most_turn_in_flight;
    const double cut = longest_substep(dt, may_fly ? in_flight : most_turn);
    // What is late takes what is left at once, as far as it need not be cut: to try more takes more time.
    double usual = dt / substeps;
    if (usual < std::min(cut, left_) && report.is_late()) usual = left_;
    const double least = report.has_spent_work() ? usual : dt / most_cuts;
    const double longest = std::max(std::min(usual, cut), least);
    double h = left_ / std::ceil(left_ / std::min(longest, likely) - 1e-9);
    now_ = start + dt - left_;
    ground_.find(surroundings, now_);
    if (may_fly) {
      // A step of twice the length is cut alike, so that comparing tells no error: is_blind reads halvings.
      report.halvings += rules.is_watched && cut < usual;
      may_fly = is_alone(surroundings, h) && fly(rules.time_order, h, report);
      if (!may_fly) continue;
      ++report.direct_substeps;
      left_ -= h;
      continue;
    }
    const double tried = h;
    h = solve(cluster, surroundings, h, least, report);
    if (h == 0) break;
    ++report.direct_substeps;
    left_ -= h;
    if (has_nets_ || islands_[0].state->on_ground)
      likely = h * (!has_nets_ ? 2 : h < tried ? 1 : grows_on_net);
  }
  for (LinkageState* const state : cluster) state->free_waves();
}

/// Whether nothing is near the only island in a substep.
bool ClusterStepper::is_alone(const Surroundings& surroundings, double h) const {
  const LinkageState& state = *islands_[0].state;
  return !state.linkage->has_shapes() ||
         (!state.linkage->neighbors().any_may_touch() &&
          !surroundings.reach_into(reach(state, top_speed(state), h, settings_.margin),
                                   state.linkage->filters()));
}

/// One substep of a higher order. False, and nothing has moved, if limits, drives or friction of joints may
/// push.
bool ClusterStepper::fly(std::uint32_t time_order, double h, Tally& report) {
  Island& island = islands_[0];
  LinkageState& state = *island.state;
  if (!state.linkage->angles().empty()) {
    start(island, h);
    find_contacts(h);
    state.factored = state.factored && state.laws.empty();
    if (!rows_.empty()) return false;
  }
  if (!state.can_follow_elastics(h)) return false;
  state.forget_waves();
  island.theta = 0;
  island.d.assign(state.x.size(), Vec3{});
  find_bounds(island);
  const double before = energy();
  if (!flight_.step(state, time_order, h, report)) return false;
  island.v = state.v;
  if (!state.is_driven())
    guard_energy(before, 0, false, false, report);
  else if (state.laws.empty())
    state.energy.reset();
  std::copy_n(island.v.begin(), state.linkage->movable(), state.v.begin());
  state.kept.clear();
  return true;
}

double ClusterStepper::longest_substep(double most, double turn) {
  double out = most;
  top_speeds_.clear();
  for (std::uint32_t i = 0; i < count_; ++i) {
    const Island& island = islands_[i];
    top_speeds_.push_back(island.awake ? top_speed(*island.state) : 0);
    if (!island.awake) continue;
    const double turning = island.state->linkage->turning(island.state->v, island.state->lengths.squares(),
                                                          island.state->broken);
    if (turning * out > turn) out = turn / turning;
  }
  if (count_ == 1) return out;
  // Two islands matter only if they may meet until then.
  const double until = out;
  island_bounds_.clear();
  for (std::uint32_t i = 0; i < count_; ++i) {
    Island& island = islands_[i];
    island.bounds = bounds_of(*island.state->linkage, island.state->x, 0);
    island_bounds_.push_back(grown(island.bounds, until * top_speeds_[i]));
  }
  for (const auto [i, j] : close_islands_.find(island_bounds_)) {
    const Island &a = islands_[i], &b = islands_[j];
    if (!a.awake && !b.awake) continue;
    const double speed = top_speeds_[i] + top_speeds_[j];
    const double near = most_approach * (a.state->linkage->thinness() + b.state->linkage->thinness());
    out = std::min(out, std::max(near, distance(a.bounds, b.bounds)) / (speed + 1e-30));
  }
  return out;
}

// Puts the island back to where it was before the substep, for good.
void ClusterStepper::freeze(Island& island, Tally& report) {
  LinkageState& state = *island.state;
  std::swap(state.x, island.there);
  std::fill_n(state.v.begin(), state.linkage->movable(), Vec3{});
  state.freeze();
  island.awake = false;
  ++report.frozen_islands;
}

void ClusterStepper::start(Island& island, double h) {
  LinkageState& state = *island.state;
  const Linkage& linkage = *state.linkage;
  const std::uint32_t movable = linkage.movable();
  island.is_predicted = false;
  island.theta = theta_of_substep(state);
  state.turning.clear();
  begin_given(island, h);
  island.d.resize(state.x.size());
  island.there.resize(state.x.size());
  island.v.resize(state.x.size());
  island.momentum.resize(movable);
  island.force.resize(movable);
  // The last island's numbers may not be finite, nor zero where no unknown is.
  island.unknowns.assign(linkage.plan().columns(), simd::Quad{});
  if (state.pulls.counts || linkage.breaks() || linkage.taut_rods() > 0 || island.theta > 0 ||
      state.is_driven()) {
    island.pulls.assign(linkage.constraints() + linkage.elastics().size(), 0);
    island.end_pulls.assign(island.pulls.size(), 0);
  } else {
    island.pulls.clear();
    island.end_pulls.clear();
  }
  if (island.theta == 0) {
    state.slow_waves(h);
  } else {  // directions that turn within a substep follow waves, and those at its start are not known then
    state.forget_tautness();
  }
  const double kept = linkage.kept(0.5 * h);
  // The island starts about where the pulls of the last substep would take it again. Constraints are then
  // bent only by what differs from that.
  const double farthest = farthest_pull * linkage.size() / (h * h);
  const bool again = std::all_of(state.acceleration.begin(), state.acceleration.end(),
                                 [&](Vec3 a) { return dot(a, a) <= farthest * farthest; });
  for (std::size_t i = 0; i < state.x.size(); ++i) {
    island.v[i] = i < movable ? kept * state.v[i] : state.v[i];
    island.d[i] = h * island.v[i];
    if (again && i < movable) island.d[i] += (h * h) * state.acceleration[i];
    island.there[i] = state.x[i] + island.d[i];
  }
  island.elastics.resize(state.laws.size());
  if (!state.laws.empty()) begin_elastics(island, h);
  linkage.forces(state.x, island.v, state.force, island.force);
  state.add_motors(island.force);
  state.start_momenta(island.v, island.momentum);
  island.h = h;
  island.kick = island.theta == 1 ? h * h : 0.5 * h * h;
  for (std::uint32_t i = 0; i < movable; ++i)
    island.momentum[i] = h * island.momentum[i] + island.kick * island.force[i];
  if (!state.on_ground) predict(island);
}

/// Finds where the island goes if nothing touches it.
void ClusterStepper::predict(Island& island) {
  LinkageState& state = *island.state;
  const Linkage& linkage = *state.linkage;
  turn(island);
  if (island.theta > 0 || !state.laws.empty())
    state.factor_with_elastics(island.directions(),
                               [&](std::size_t i) { return island.elastics[i].soft_of_positions(); });
  else if (!state.factored)
    state.factor();
  const std::span<double> right = island.right();
  linkage.targets(island.directions(), island.d, island.there, state.lengths.squares(), right);
  linkage.put(island.momentum, right);
  aim_elastics(island);
  state.solve(island.unknowns);
  pull_elastics(island, 1);
  island.take_pulls(island.pulls, 0, 1);
  for (std::uint32_t i = 0; i < linkage.movable(); ++i) island.d[i] = linkage.taken(right, i);
  island.is_predicted = true;
}

bool ClusterStepper::substep(const Surroundings& surroundings, double h, Tally& report) {
  all_near_ = false;
  find_stillness(h);
  keeps_slack_ = false;
  may_touch_ = is_held();
  switches_ = 0;
  bool is_found = find_sound_positions(h, report);
  if (learn_tautness(h)) is_found = find_sound_positions(h, report);
  is_unfound_ = !is_found && !found_crowd_ && !buckles_;
  if (!is_found) return false;
  const double start = energy();
  double before = start + work_of_given(&Island::pulls, now_) / h;
  const Energies held = energies_of_elastics();
  const bool touched = std::any_of(rows_.begin(), rows_.end(), [](const Row& row) { return row.p != 0; }) ||
                       count_pushes() > 0;
  finish(h, touched);
  if (touched) bounce(h);
  if (touched && surroundings.may_move()) before += work_of_ground(h);
  before += work_of_given(&Island::end_pulls, now_ + h) + work_of_common(h);
  for (std::uint32_t i = 0; i < count_; ++i)
    if (islands_[i].awake) brake(islands_[i], h);
  if (!guard_driven(start + held.all, surroundings, h > shortest_) ||
      !guard(before, held, touched, h > shortest_, report)) {
    take_back();
    return false;
  }
  for (std::uint32_t i = 0; i < count_; ++i) {
    const Island& island = islands_[i];
    if (!island.awake) continue;
    LinkageState& state = *island.state;
    if (state.pulls.counts) count_pulls(islands_[i], h);
    const double kept = state.linkage->kept(0.5 * h);
    for (std::uint32_t k = 0; k < state.linkage->movable(); ++k) {
      state.acceleration[k] = (1 / (h * h)) * (island.d[k] - h * kept * state.v[k]);
      state.v[k] = island.v[k];
    }
    state.keep_given();
    if (island.theta == 0) state.follow_tautness(island.pulls, h);
    keep_elastics(islands_[i], h);
  }
  if (touched) count_pushes(h);
  keep_contacts(h);
  if (touched) unbalance();
  for (std::uint32_t i = 0; i < count_; ++i)
    if (islands_[i].awake && !is_finite(*islands_[i].state)) freeze(islands_[i], report);
  for (std::uint32_t i = 0; i < count_; ++i)
    if (islands_[i].awake) report.broken_rods += break_rods(islands_[i], h);
  report.missed_contacts += gives_up_missed_;
  report.contact_points = std::max(report.contact_points, count_points());
  return true;
}

/// Returns at how many points something pushes.
std::uint64_t ClusterStepper::count_points() const {
  const auto pushes = [](const Row& row) { return row.kind == Kind::normal && row.p > 0; };
  return count_pushes() + static_cast<std::uint64_t>(std::count_if(rows_.begin(), rows_.end(), pushes));
}

/// Where islands start, nothing is known of how taut their rods are but by a try. Returns whether positions
/// are to be found again, with waves slowed.
bool ClusterStepper::learn_tautness(double h) {
  bool slows = false;
  for (std::uint32_t i = 0; i < count_; ++i)
    if (islands_[i].awake && islands_[i].theta == 0)
      slows = islands_[i].state->learn_tautness(islands_[i].pulls, h) || slows;
  return slows;
}

/// Finds positions again while something is missed, or elastics are slack that were not. Returns false, too,
/// where rods are to buckle first.
bool ClusterStepper::find_sound_positions(double h, Tally& report) {
  missed_ground_.clear();
  missed_pairs_.clear();
  gives_up_missed_ = buckles_ = false;
  do {
    while (!find_positions(h, report)) {
      if (!knows_answers_) return false;
      if (let_go_of_held(false)) continue;
      find_buckling(false);
      return false;
    }
    while (find_missed_contacts()) {
      all_near_ = keeps_slack_ = true;
      if (!find_positions(h, report)) return false;
    }
    for (int i = 0; find_missed(); ++i) {
      if (i == most_missed && h > shortest_if_missed_) return false;
      gives_up_missed_ = i == most_missed;
      if (gives_up_missed_) break;
      keeps_slack_ = true;
      if (!find_positions(h, report)) return false;
    }
  } while (switch_elastics() || let_go_of_held(true));
  gives_up_missed_ = gives_up_missed_ || std::any_of(rows_.begin(), rows_.end(),
                                                     [&](const Row& row) { return is_held_in_ground(row); });
  if (find_buckling(true)) return false;
  is_squeezed_ = std::any_of(rows_.begin(), rows_.end(), [&](const Row& row) { return is_driven_in(row); });
  if (is_squeezed_) strain_ = Strain::pressed;
  return !is_squeezed_;
}

/// Returns the work (J) that ground which moves does in the substep.
double ClusterStepper::work_of_ground(double h) const {
  double sum = 0;
  for (const Row& row : rows_) sum += row.p * row.given / (h * h) + row.q * row.given_at_end;
  for (std::uint32_t i = 0; i < count_; ++i)
    islands_[i].ground.for_kept([&](const GroundContact& contact, Vec3 position, Vec3 end) {
      sum += dot(position, contact.more->carried) / (h * h) + dot(end, contact.more->carried_at_end);
    });
  return sum;
}

bool ClusterStepper::find_positions(double h, Tally& report) {
  for (std::uint32_t i = 0; i < count_; ++i)
    if (islands_[i].awake) start(islands_[i], h);
  for (bool again = true; again;) {
    again = false;
    find_contacts(h);
    for (std::uint32_t i = 0; i < count_; ++i) {
      Island& island = islands_[i];
      if (island.awake && !island.is_predicted && island.ground.is_empty()) {
        predict(island);  // its contacts are to be found again, where it flies
        again = true;
      }
    }
    for (std::uint32_t i = 0; i < count_; ++i)
      if (!islands_[i].state->asleep && !islands_[i].awake && !islands_[i].state->frozen) {
        again = true;
        islands_[i].awake = true;
        islands_[i].state->slow_time = 0;
        islands_[i].state->pulls.begin_step();
        start(islands_[i], h);
      }
  }
  if (leaves_middle()) return find_positions(h, report);
  knows_answers_ = false;
  for (std::uint32_t i = 0; i < count_; ++i)
    if (!islands_[i].ground.is_empty() && !start_on_ground(islands_[i])) return false;
  is_wide_ = is_wide();
  if (!rows_.empty()) find_responses(false);
  knows_answers_ = true;
  return solve_positions(report);
}

}  // namespace plumb::detail
