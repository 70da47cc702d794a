// This file moves islands that touch ground in many places.

#include <algorithm>
#include <cmath>

#include "contact/solved/cluster_limits.hpp"
#include "contact/solved/cluster_stepper.hpp"

namespace plumb::detail {
using namespace contact_limits;

std::size_t ClusterStepper::count_pushes() const {
  std::size_t sum = 0;
  for (std::uint32_t i = 0; i < count_; ++i) sum += islands_[i].ground.count_pushes();
  return sum;
}

/// Factorises the island's matrix with the ground's slopes of the last look, for positions or for velocities
/// at the end.
bool ClusterStepper::factor_on_ground(Island& island, bool is_end) {
  const std::span<const Vec3> at = is_end ? island.state->x : island.directions();
  island.state->assemble_with_elastics(at, [&](std::size_t i) {
    const ElasticStep& step = island.elastics[i];
    return is_end ? step.soft_at_end() : step.soft_of_positions();
  });
  island.answers_anew = true;
  return island.ground.factor(*island.state);
}

/// Finds where the island goes with the ground's slopes at the guess, or where it would fly. Returns false if
/// its matrix has no factors.
bool ClusterStepper::start_on_ground(Island& island) {
  LinkageState& state = *island.state;
  const Linkage& linkage = *state.linkage;
  const std::span<double> right = island.right();
  for (std::size_t k = 0; k < state.x.size(); ++k) island.there[k] = state.x[k] + island.d[k];
  turn(island);
  island.ground.begin_positions(loose_, tight_);
  island.ground.follow_gaps(state, island.there);
  island.ground.look(linkage, island.d, true);
  if (!factor_on_ground(island, false)) return false;
  linkage.targets(island.directions(), island.d, island.there, state.lengths.squares(), right);
  linkage.put(island.momentum, right);
  aim_elastics(island);
  island.ground.add_pushes(linkage, island.d, right);
  state.solve(island.unknowns);
  for (ElasticStep& step : island.elastics) step.p = 0;
  pull_elastics(island, 1);
  island.take_pulls(island.pulls, 0, 1);
  for (std::uint32_t k = 0; k < linkage.movable(); ++k) island.d[k] = linkage.taken(right, k);
  island.ground.follow_solution(island.d);
  return true;
}

/// Takes a Newton step towards what its constraints and the ground ask for. Island::right() holds minus the
/// violations of constraints. Returns false if the matrix has no factors.
bool ClusterStepper::correct_on_ground(Island& island) {
  LinkageState& state = *island.state;
  const Linkage& linkage = *state.linkage;
  const std::span<double> right = island.right();
  if (island.ground.is_stale() && !factor_on_ground(island, false)) return false;
  island.ground.add_lack(linkage, right);
  state.solve(island.unknowns);
  island.step.assign(state.x.size(), Vec3{});
  for (std::uint32_t k = 0; k < linkage.movable(); ++k) island.step[k] = linkage.taken(right, k);
  island.ground.aim(island.step);
  const double share = island.ground.share_of(state.inertia_product(island.step));
  island.ground.take(share);
  take_lag(island, share);
  pull_elastics(island, share);
  island.take_pulls(island.pulls, 1, share);
  for (std::uint32_t k = 0; k < linkage.movable(); ++k) {
    island.d[k] += share * island.step[k];
    island.there[k] = state.x[k] + island.d[k];
  }
  return true;
}

/// Finds velocities of an island that ground holds, from a guess of them, with what pulls there.
void ClusterStepper::find_velocities_on_ground(Island& island) {
  do balance_velocities(island);
  while (let_go_at_end(island));
}

void ClusterStepper::balance_velocities(Island& island) {
  LinkageState& state = *island.state;
  const Linkage& linkage = *state.linkage;
  const std::span<double> right = island.right();
  for (int step = 0; step < most_ground_corrections; ++step) {
    island.ground.look(linkage, island.v, step < bounds_follow_for);
    if (step > 0 && island.ground.lack() <= ground_enough) return;
    if ((step == 0 || island.ground.is_stale()) && !factor_on_ground(island, true)) return;
    std::fill(right.begin(), right.end(), 0.0);
    fill_velocities(island);
    island.ground.add_pushes(linkage, island.v, right);
    state.solve(island.unknowns);
    island.step.assign(state.x.size(), Vec3{});
    for (std::uint32_t k = 0; k < linkage.movable(); ++k)
      island.step[k] = linkage.taken(right, k) - island.v[k];
    island.ground.aim(island.step);
    const double share = step == 0 ? 1 : island.ground.share_of(state.inertia_product(island.step));
    island.ground.take(share);
    island.take_pulls(island.end_pulls, 1 - share, share);
    for (std::uint32_t k = 0; k < linkage.movable(); ++k) island.v[k] += share * island.step[k];
  }
}

}  // namespace plumb::detail
