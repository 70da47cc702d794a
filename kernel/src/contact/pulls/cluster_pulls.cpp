// This file adds up what holds and pushes a cluster's islands in a substep.

#include <utility>

#include "contact/cluster_stepper.hpp"

namespace plumb::detail {

/// Adds what constraints and elastics pulled with. Island::there is where the substep began.
void ClusterStepper::count_pulls(Island& island, double h) const {
  LinkageState& state = *island.state;
  const Linkage& linkage = *state.linkage;
  linkage.count_pulls(island.there, island.pulls, 1 / h, state.pulls);
  linkage.count_pulls(state.x, island.end_pulls, 1, state.pulls);
  for (std::size_t i = 0; i < state.laws.size(); ++i) {
    const ElasticStep& step = island.elastics[i];
    if (!step.acts) continue;
    const bool is_held = step.soft_at_end() >= 0;
    const double end = is_held ? island.end_pulls[linkage.constraints() + i] : 0;
    linkage.count_pull(i, island.there, -step.p / h, state.pulls);
    linkage.count_pull(i, state.x, end - step.end_kick(h), state.pulls);
  }
  const auto near = [&](std::size_t i) { return island.elastics[i].start; };
  state.count_motors(0.5 * h, island.there, near);
  state.count_motors(0.5 * h, state.x, near);
}

/// Adds what a contact, or a limit or the friction of an angle, pushed with.
void ClusterStepper::count_pushes(const Row& row, double h) {
  const double impulse = row.p / h + row.q;
  if (impulse == 0) return;
  const bool is_contact = row.kind == Kind::normal || row.kind == Kind::sliding;
  for (std::uint32_t i = 0; i < row.ends; ++i) {
    Island& island = islands_[row.island[i]];
    LinkagePulls& pulls = island.state->pulls;
    if (!pulls.counts) continue;
    const Side& side = island.sides[row.side[i]];
    if (is_contact)
      pulls.shapes[row.of[i]] += impulse * side.along_a;
    else
      pulls.angles[row.of[i]] += (row.key & 1) != 0 ? -impulse : impulse;
    for (const auto& [sum, along] : {std::pair{side.a, side.along_a}, std::pair{side.b, side.along_b}}) {
      Combination at;
      for (std::uint32_t k = sum.first; k < sum.end; ++k)
        at.add(island.terms[k].particle, island.terms[k].weight);
      island.state->linkage->push_fixed(at, impulse * along, pulls);
    }
  }
}

void ClusterStepper::count_pushes(double h) {
  for (const Row& row : rows_) count_pushes(row, h);
  for (std::uint32_t i = 0; i < count_; ++i) {
    LinkageState& state = *islands_[i].state;
    if (!state.pulls.counts) continue;
    islands_[i].ground.for_kept([&](const GroundContact& contact, Vec3 position, Vec3 end) {
      const Vec3 impulse = (1 / h) * position + end;
      state.pulls.shapes[contact.shape] += impulse;
      state.linkage->push_fixed(contact.at, impulse, state.pulls);
    });
  }
}

}  // namespace plumb::detail
