// This file moves the elastics of a cluster's islands within a substep.

#include <algorithm>
#include <cmath>
#include <cstdint>

#include "contact/solved/cluster_limits.hpp"
#include "contact/solved/cluster_stepper.hpp"
#include "plumb/layouts/memory.hpp"

namespace plumb::detail {
using namespace contact_limits;

/// Begins a substep from Island::there.
void ClusterStepper::begin_elastics(Island& island, double h) const {
  LinkageState& state = *island.state;
  const std::span<const Elastic> elastics = state.linkage->elastics();
  make_room_to_damp(island);
  state.follow_bends(h);
  state.find_gives();
  for (std::size_t i = 0; i < elastics.size(); ++i) {
    const ElasticLaw& law = state.laws[i];
    ElasticStep& step = island.elastics[i];
    const bool was_taut = step.acts;
    step = {.acts = law.stiffness != 0 || law.damping != 0, .start = state.elastic_numbers[i]};
    if (!state.elastic_rates.empty()) step.went = state.elastic_rates[i];
    if (law.one_sided) {
      const double there = state.linkage->number(elastics[i], island.there, step.start);
      // What just fits may pull as well: free flight keeps lengths, so that it finds the uppermost alone.
      const bool may_pull = std::max(there, step.start) >= (1 - exact) * law.rest;
      step.acts = step.acts && (keeps_slack_ ? was_taut : may_pull);
    }
    if (step.acts) step.begin(law, state.gives[i], h, island.theta == 1);
  }
}

/// Writes what rows of elastics ask of a solution near Island::d, as Linkage::targets() does for constraints.
void ClusterStepper::aim_elastics(Island& island) {
  const LinkageState& state = *island.state;
  const Linkage& linkage = *state.linkage;
  for (std::size_t i = 0; i < state.laws.size(); ++i) {
    const ElasticStep& step = island.elastics[i];
    const Elastic& elastic = linkage.elastics()[i];
    if (!step.acts) continue;
    const double along =
        Linkage::rate(elastic, linkage.slope(elastic, island.directions()), island.d, linkage.movable_ones());
    const double off = linkage.number(elastic, island.there, step.start) - state.laws[i].rest;
    island.right()[linkage.plan().position(elastic.row)] = along - off - step.before;
  }
}

/// Writes by how much rows of elastics are missed at Island::there, times -1. Returns the largest share of
/// lengths, or angle.
double ClusterStepper::elastic_misfit(Island& island) {
  const LinkageState& state = *island.state;
  const Linkage& linkage = *state.linkage;
  double worst = 0;
  for (std::size_t i = 0; i < state.laws.size(); ++i) {
    const ElasticStep& step = island.elastics[i];
    const Elastic& elastic = linkage.elastics()[i];
    if (!step.acts) continue;
    const double off = linkage.number(elastic, island.there, step.start) - state.laws[i].rest;
    const double miss = off + step.soft * step.p + step.before;
    island.right()[linkage.plan().position(elastic.row)] = -miss;
    const bool is_length = !linkage.is_of_bend(i) &&
                           (elastic.kind == Elastic::Kind::distance || elastic.kind == Elastic::Kind::along);
    worst = std::max(worst, std::abs(miss) / (is_length ? linkage.size() : 1));
  }
  return std::isfinite(worst) ? worst : INFINITY;
}

/// Adds to pulls this share of what the last solution says of them.
void ClusterStepper::pull_elastics(Island& island, double share) {
  const Linkage& linkage = *island.state->linkage;
  for (std::size_t i = 0; i < island.state->laws.size(); ++i)
    if (island.elastics[i].acts)
      island.elastics[i].p -= share * island.right()[linkage.plan().position(linkage.elastics()[i].row)];
}

/// Kicks Island::impulse by what pulls leave for the end, and factorises the matrix of velocities.
void ClusterStepper::end_elastics(Island& island, double h) {
  LinkageState& state = *island.state;
  const Linkage& linkage = *state.linkage;
  if (state.laws.empty()) return;
  for (std::size_t i = 0; i < state.laws.size(); ++i) {
    const Elastic& elastic = linkage.elastics()[i];
    ElasticStep& step = island.elastics[i];
    if (!step.acts) continue;
    step.end_push = island.theta == 1 ? 0 : step.p / h;
    linkage.push_along(elastic, linkage.slope(elastic, state.x), step.end_push, island.impulse);
    step.end_rate = step.rate_at_end((linkage.number(elastic, state.x, step.start) - step.start) / h);
  }
  state.factor_with_elastics([&](std::size_t i) { return island.elastics[i].soft_at_end(); });
  island.answers_anew = true;
}

/// Keeps numbers and rates of elastics after a substep of h (s).
void ClusterStepper::keep_elastics(Island& island, double h) {
  LinkageState& state = *island.state;
  state.follow_elastics(h);
  for (std::size_t i = 0; i < state.laws.size(); ++i)
    if (!island.elastics[i].acts) state.elastic_rates[i] = std::numeric_limits<double>::quiet_NaN();
}

/// Lets go of cables that would push where the substep ends, and factorises the matrix of velocities without
/// them. Returns whether there are any, so that velocities are to be found again.
bool ClusterStepper::let_go_at_end(Island& island) {
  LinkageState& state = *island.state;
  const Linkage& linkage = *state.linkage;
  bool is_changed = false;
  for (std::size_t i = 0; i < state.laws.size(); ++i) {
    ElasticStep& step = island.elastics[i];
    if (!state.laws[i].one_sided || step.soft_at_end() < 0) continue;
    const Elastic& elastic = linkage.elastics()[i];
    if (island.right()[linkage.plan().position(elastic.row)] >= step.end_push) continue;
    linkage.push_along(elastic, linkage.slope(elastic, state.x), -step.end_push, island.impulse);
    step.end_push = 0;
    step.lets_go = is_changed = true;
  }
  if (!is_changed) return false;
  state.factor_with_elastics([&](std::size_t i) { return island.elastics[i].soft_at_end(); });
  return island.answers_anew = true;
}

/// Writes the rates to which elastics hold velocities, beside anchors that move.
void ClusterStepper::hold_elastics(Island& island) {
  const LinkageState& state = *island.state;
  const Linkage& linkage = *state.linkage;
  for (std::size_t i = 0; i < state.laws.size(); ++i) {
    const Elastic& elastic = linkage.elastics()[i];
    const ElasticStep& step = island.elastics[i];
    if (step.soft_at_end() < 0) continue;
    island.right()[linkage.plan().position(elastic.row)] =
        step.end_rate -
        Linkage::rate(elastic, linkage.slope(elastic, state.x), state.v, linkage.fixed_ones());
  }
}

/// Lets go of cables that would push, and takes up those that are too long. Returns whether there are any,
/// so that the substep is to be solved again.
bool ClusterStepper::switch_elastics() {
  bool is_changed = false;
  for (std::uint32_t i = 0; i < count_; ++i) {
    Island& island = islands_[i];
    if (!island.awake) continue;
    const LinkageState& state = *island.state;
    for (std::size_t k = 0; k < state.laws.size(); ++k) {
      ElasticStep& step = island.elastics[k];
      const ElasticLaw& law = state.laws[k];
      if (!law.one_sided || (law.stiffness == 0 && law.damping == 0)) continue;
      const double end = state.linkage->number(state.linkage->elastics()[k], island.there, step.start);
      // Cables that change their mind stay slack in the end.
      const bool pulls = step.acts ? step.p <= 0 : end > law.rest && 2 * switches_ < most_switches;
      is_changed = is_changed || pulls != step.acts;
      step.acts = pulls;
    }
  }
  keeps_slack_ = true;
  return is_changed && ++switches_ < most_switches;
}

/// Lets go of cables that are as if rigid where a contact asks them to shorten: what hangs straight above
/// ground answers to no push while they act, and what hangs nearly straight hardly does. The latter matters
/// where no positions were found. Returns whether there are any, as switch_elastics() does.
bool ClusterStepper::let_go_of_held(bool is_found) {
  bool is_changed = false;
  for (const Row& row : rows_)
    for (std::uint32_t k = 0; k < row.ends; ++k)
      if (is_found ? is_held_in_ground(row) : hardly_answers(row)) {
        Island& island = islands_[row.island[k]];
        is_changed = (island.awake && let_go(island, island.sides[row.side[k]])) || is_changed;
      }
  keeps_slack_ = keeps_slack_ || is_changed;
  return is_changed && ++switches_ < most_switches;
}

/// Returns whether a contact pushes, and is answered by little of what free particles would answer with.
bool ClusterStepper::hardly_answers(const Row& row) const {
  if (row.kind != Kind::normal || is_wide_) return false;
  double free = 0;
  for (std::uint32_t k = 0; k < row.ends; ++k) {
    const Island& island = islands_[row.island[k]];
    const Side& side = island.sides[row.side[k]];
    for (std::uint32_t t = side.a.first; t < side.a.end; ++t)
      if (const auto [particle, weight] = island.terms[t]; particle < island.state->linkage->movable())
        free += weight * weight * dot(side.along_a, side.along_a) / island.state->linkage->mass_of(particle);
  }
  return (row.over == 0 || row.p > 0) && row.own < nearly_straight * free;
}

/// Adds what a side's push by so much is on particles.
void ClusterStepper::add_push(const Island& island, const Side& side, double by, std::span<Vec3> pushes) {
  const auto add = [&](Sum sum, Vec3 along) {
    for (std::uint32_t t = sum.first; t < sum.end; ++t)
      if (const auto [particle, weight] = island.terms[t]; particle < pushes.size())
        pushes[particle] += (by * weight) * along;
  };
  add(side.a, side.along_a);
  add(side.b, side.along_b);
}

/// Lets go of an island's acting cables that a push on a side shortens. Returns whether there are any.
bool ClusterStepper::let_go(Island& island, const Side& side) {
  const LinkageState& state = *island.state;
  const Linkage& linkage = *state.linkage;
  if (state.laws.empty()) return false;
  Array<Vec3>& push = island.impulse;  // which the end of a substep writes anew
  push.assign(linkage.movable(), Vec3{});
  add_push(island, side, 1, push);
  bool is_changed = false;
  for (std::size_t i = 0; i < state.laws.size(); ++i) {
    ElasticStep& step = island.elastics[i];
    const Elastic& elastic = linkage.elastics()[i];
    if (!step.acts || !state.laws[i].one_sided) continue;
    const ElasticSlope slope = linkage.slope(elastic, island.directions());
    if (Linkage::rate(elastic, slope, push, linkage.movable_ones()) >= 0) continue;
    step.acts = false;
    is_changed = true;
  }
  return is_changed;
}

}  // namespace plumb::detail
