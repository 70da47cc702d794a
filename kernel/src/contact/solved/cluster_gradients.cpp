// This file takes the directions of constraints where a gradient says: in the middle of a substep, or at its
// end.

#include <algorithm>
#include <cmath>

#include "contact/solved/cluster_stepper.hpp"
#include "time/verlet.hpp"

namespace plumb::detail {
namespace {

/// Adds how elastics pull along Island::along instead of where the factors have them.
void add_turned_elastics(ClusterIsland& island) {
  const Linkage& linkage = *island.state->linkage;
  for (std::size_t i = 0; i < island.elastics.size(); ++i) {
    const Elastic& elastic = linkage.elastics()[i];
    const double push = island.elastics[i].p;
    if (push == 0) continue;
    linkage.push_along(elastic, linkage.slope(elastic, island.along), push, island.lag);
    linkage.push_along(elastic, linkage.slope(elastic, island.at), -push, island.lag);
  }
}

/// Adds how air resists the mean velocity of the substep there, instead of that of its start.
void add_turned_air(ClusterIsland& island) {
  const Linkage& linkage = *island.state->linkage;
  island.step.resize(island.d.size());
  for (std::size_t k = 0; k < island.d.size(); ++k) island.step[k] = (1 / island.h) * island.d[k];
  island.impulse.resize(linkage.movable());
  linkage.forces(island.along, island.step, island.state->force, island.impulse);
  for (std::uint32_t k = 0; k < linkage.movable(); ++k)
    island.lag[k] += island.kick * (island.impulse[k] - island.force[k]);
}

}  // namespace

/// Returns where an island takes its directions. In the middle it can do so in flight alone, since what
/// touches needs velocities that end along constraints. Elastics have a rule of their own, and rods that do
/// not fit swing about where they would.
double ClusterStepper::theta_of_substep(const LinkageState& state) const {
  if (takes_end_ && !state.laws.empty()) return 1;
  const bool is_flying = !may_touch_ && state.laws.empty() && state.strain == Strain::none;
  return state.gradient == Gradient::mid && !is_flying ? 0 : theta_of(state.gradient);
}

/// Returns whether something was pushed in the last substep, and probably is in this one.
bool ClusterStepper::is_held() const {
  return std::any_of(islands_.begin(), islands_.begin() + count_,
                     [](const Island& each) { return !each.state->kept.empty(); });
}

/// Returns whether islands are to start again with their directions at the start, because something is near.
bool ClusterStepper::leaves_middle() {
  if (may_touch_ || (rows_.empty() && !is_on_ground())) return false;
  may_touch_ = true;
  return std::any_of(islands_.begin(), islands_.begin() + count_,
                     [](const Island& each) { return each.awake && each.theta == 0.5; });
}

/// Returns whether some island takes its directions elsewhere than at the start.
bool ClusterStepper::turns() const {
  return std::any_of(islands_.begin(), islands_.begin() + count_,
                     [](const Island& each) { return each.awake && each.theta > 0; });
}

/// Puts the directions of the next factors where Island::d says.
void ClusterStepper::turn(Island& island) {
  if (island.theta == 0) return;
  const LinkageState& state = *island.state;
  island.at.resize(state.x.size());
  island.along.resize(state.x.size());
  for (std::size_t k = 0; k < state.x.size(); ++k) island.at[k] = state.x[k] + island.theta * island.d[k];
  island.bent.assign(state.linkage->movable(), Vec3{});
  island.last_violation = INFINITY;
}

/// Takes note of what the matrix took of a correction for pulls that turn with it, which add_lag() looks at
/// itself.
void ClusterStepper::take_turning(Island& island, std::span<const Vec3> by) {
  const LinkageState& state = *island.state;
  if (state.turning.empty()) return;
  island.lag.assign(state.linkage->movable(), Vec3{});
  state.linkage->add_wave_momenta(state.turning, state.turning, by, island.lag);
  for (std::size_t k = 0; k < island.bent.size(); ++k) island.bent[k] -= island.lag[k];
}

/// Puts the directions of the factors where Island::d has come to, and lets the matrix know pulls of now.
/// What is left to do stays the same.
void ClusterStepper::turn_anew(Island& island) {
  LinkageState& state = *island.state;
  for (std::size_t k = 0; k < state.x.size(); ++k) {
    const Vec3 to = state.x[k] + island.theta * island.d[k];
    island.along[k] = island.at[k] - to;
    island.at[k] = to;
  }
  state.linkage->add_pulls(island.along, island.pulls, island.bent);
  state.follow_turning(island.pulls);
  state.factor_with_elastics(island.at, [](std::size_t) { return -1.0; });
}

/// Adds to the right hand side what constraints push with along the directions of Island::d, beyond those of
/// the factors and what the last solution has of that. Returns the largest share of its size that a particle
/// would move by.
///
/// With it corrections lead to M d = momentum - J(x + theta d)ᵀ multipliers. Each leaves a share of the
/// error: (h w)² at the end and a quarter of that in the middle, w being the frequency at which pulls let
/// rods swing.
double ClusterStepper::add_lag(Island& island) {
  const LinkageState& state = *island.state;
  const Linkage& linkage = *state.linkage;
  for (std::size_t k = 0; k < state.x.size(); ++k)
    island.along[k] = state.x[k] + island.theta * island.d[k] - island.at[k];
  island.lag.assign(linkage.movable(), Vec3{});
  linkage.add_pulls(island.along, island.pulls, island.lag);
  for (std::size_t k = 0; k < state.x.size(); ++k) island.along[k] += island.at[k];
  if (!state.laws.empty()) add_turned_elastics(island);
  if (linkage.has_air()) add_turned_air(island);
  for (std::uint32_t k = 0; k < linkage.movable(); ++k) island.lag[k] -= island.bent[k];
  linkage.put(island.lag, island.right());
  const double most = linkage.largest_move(island.lag) / linkage.size();
  return std::isfinite(most) ? most : INFINITY;
}

/// Takes note that this share of a correction was taken.
void ClusterStepper::take_lag(Island& island, double share) {
  if (island.theta == 0) return;
  for (std::size_t k = 0; k < island.bent.size(); ++k) island.bent[k] += share * island.lag[k];
}

/// Ends a substep whose directions were not those of its start. Returns false if velocities are still to be
/// found, because something pushes.
bool ClusterStepper::end_turned(Island& island, double h, bool touched) {
  LinkageState& state = *island.state;
  const std::uint32_t movable = state.linkage->movable();
  for (std::size_t k = 0; k < island.at.size(); ++k)
    island.at[k] = island.there[k] + island.theta * island.d[k];
  state.factored = false;
  state.turning.clear();
  if (island.theta == 1 && touched && (!island.sides.empty() || !island.ground.is_empty())) return false;
  for (std::uint32_t k = 0; k < movable; ++k) {
    const Vec3 mean = (1 / h) * island.d[k];
    island.v[k] = island.theta == 1 ? mean : 2 * mean - island.v[k];
  }
  return true;
}

/// Returns whether gradient mid has moved all islands, so that energy is as it should be.
bool ClusterStepper::keeps_energy() const {
  bool any = false;
  for (std::uint32_t i = 0; i < count_; ++i) {
    const Island& island = islands_[i];
    if (!island.awake) continue;
    if (island.theta != 0.5) return false;
    any = true;
    island.state->energy.reset();
  }
  return any;
}

}  // namespace plumb::detail
