#include <algorithm>
#include <cmath>

#include "direct/laws/held_rods.hpp"
#include "direct/loops/loop_newton.hpp"
#include "direct/loops/loop_stepper.hpp"
#include "direct/loops/loop_vectors.hpp"
#include "direct/trees/newton_limits.hpp"
#include "math/elementary.hpp"
#include "time/verlet.hpp"

namespace plumb::detail {
namespace {

/// A projection takes kinetic energy away, but for what anchors, lengths and forces add. One that makes it so
/// many times as large as all of that has divided by rounding. With the energy as the square of a norm, of
/// velocities v, and of a motion w that goes along with anchors and lengths, it leaves
///
///   |w + P(v - w)|^2 <= (|v| + 2|w|)^2 <= 5 (|v|^2 + |w|^2).
///
/// Mass along rods, which is left out here, makes that three times as large.
constexpr double most_growth = 16;
/// What jumps give where rods are levers may be so many times what they give in a common motion.
constexpr double most_levered = tree_limits::most_projected_growth;

/// Returns twice the kinetic energy of velocities (3 per node, in m/s) that forces change for `kick` (s), in
/// units of mass times m^2/s^2.
double motion_of(const LoopState& state, std::span<const double> velocity, double kick) {
  double sum = 0;
  for (std::size_t i = 0; i < state.u.size(); ++i) {
    const double mass = state.mass[i / 3], v = velocity[i] + kick * state.force[i] / mass;
    sum += mass * (v * v);
  }
  return sum;
}

/// Returns the same of all nodes together where they go as fast as any fixed vertex, and as all lengths that
/// change.
double motion_driven(const LoopState& state) {
  double mass = 0, fastest = 0, hauled = 0;
  for (const double m : state.mass) mass += m;
  for (const auto* const fixed : {&state.fixed_velocity, &state.fixed_last_velocity})
    for (const Vec3 v : *fixed) fastest = std::max(fastest, dot(v, v));
  for (const double rate : state.laws.rate) hauled += std::abs(rate);
  for (const LoopTackleMotion& tackle : state.tackles) hauled += std::abs(tackle.rate);
  for (const LoopReelMotion& reel : state.reels) hauled += std::abs(reel.rate);
  return mass * (fastest + hauled * hauled);
}

}  // namespace

bool LoopStepper::project_soundly(LoopState& state, const Projected& acts, LoopWorkspace& work) const {
  const double most = most_growth * motion_of(state, work.delta, acts.kick) +
                      (acts.jumps ? most_levered : most_growth) * motion_driven(state);
  project(state, acts, work);
  // Numbers that are not finite fail this comparison, too.
  if (motion_of(state, work.delta, 0) <= most) return true;
  std::fill(work.blows.begin(), work.blows.end(), 0.0);
  return false;
}

void LoopStepper::project(LoopState& state, const Projected& acts, LoopWorkspace& work) const {
  double kick = acts.kick;
  const LoopTopology& shape = *state.topology;
  std::fill(work.blows.begin(), work.blows.end(), 0.0);
  for (std::uint32_t i = shape.nodes; i < shape.vertices; ++i) {
    const Vec3 v = state.fixed_velocity[i - shape.nodes];
    put(&work.delta[3 * std::size_t{i}], v);
  }
  move_locked(state, 1, work.delta);
  if (!state.grabs.empty()) note_masses(state, work);
  if (work.lines) {
    if (project_by_lines(state, kick, work)) return;
    kick = 0;
  }
  work.laws.factors = LawFactors::of_projection(kick, state.u_step);
  measure_rods(state, work);
  if (work.net && project_net(state, kick, work)) return;
  // The factor is its own, so that it changes nothing that a later substep starts from.
  if (!shape.system && !work.projection)
    work.projection = std::make_unique<LoopWorkspace::Factor>(*work.factor(true).system, work.isa);
  LoopWorkspace::Factor& factor = work.projection ? *work.projection : work.factor(false);
  project_delta(state, {kick, acts.jumps, acts.as_before}, work, factor);
  factor.h = 0;
}

namespace {

/// Lets go of cables that a projection would push with more than `share` of what they pulled in the last
/// substep, which they do not do. Returns whether there were any.
bool let_go(LoopState& state, const LoopWorkspace& work, double share = 1) {
  if (work.lines || work.net || state.mu_kick == 0) return false;
  const double substep = std::sqrt(2 * state.mu_kick);
  const auto pushes = [&](std::size_t i) {
    return state.mu[i] < 0 && state.mu_kick * work.blows[i] > -share * substep * state.mu[i];
  };
  bool any = false;
  const auto release = [&](std::size_t i) {
    state.mu[i] = 0;
    any = true;
  };
  const std::size_t rods = state.topology->rods.size();
  for (std::uint32_t k = 0; state.laws.any() && k < rods; ++k)
    if (state.laws.is_one_sided(k) && pushes(k)) release(k);
  for (std::size_t t = 0; t < state.tackle_laws.size(); ++t)
    if (state.tackle_laws[t].is_one_sided && pushes(rods + t)) release(rods + t);
  return any;
}

}  // namespace

void LoopStepper::project_velocities(LoopState& state, LoopWorkspace& work) const {
  note_reel_blows(state, work);
  bool sound = true;
  do {
    std::copy(state.u.begin(), state.u.end(), work.delta.begin());
    sound = project_soundly(state, {.jumps = true}, work);
  } while (let_go(state, work));
  if (sound) std::copy_n(work.delta.begin(), state.u.size(), state.u.begin());
}

namespace {

/// Puts changes of speed in the place of speeds, or back.
void swap_jumps(LoopState& state, LoopWorkspace& work) {
  std::swap(state.laws.rate, state.laws.jump);
  for (LoopTackleMotion& tackle : state.tackles) std::swap(tackle.rate, tackle.jump);
  std::swap(state.fixed_velocity, work.fixed_jump);
  std::swap(state.fixed_last_velocity, work.fixed_rest);
}

/// Says whether a rigid cable pulled in the last substep.
bool pulls_by_cables(const LoopState& state) {
  const std::size_t rods = state.topology->rods.size();
  for (std::uint32_t k = 0; state.laws.any() && k < rods; ++k)
    if (state.mu[k] < 0 && state.laws.is_rigid(k) && state.laws.is_one_sided(k)) return true;
  for (std::size_t t = 0; t < state.tackle_laws.size(); ++t)
    if (state.mu[rods + t] < 0 && state.tackle_laws[t].is_rigid && state.tackle_laws[t].is_one_sided)
      return true;
  return false;
}

}  // namespace

bool LoopStepper::release_thrown_back(LoopState& state, LoopWorkspace& work) const {
  if (!pulls_by_cables(state)) return false;
  work.trial = work.delta;
  work.mu_start = work.blows;
  for (std::size_t i = 0; i < state.u.size(); ++i) work.delta[i] += state.u[i];
  if (project_soundly(state, {.as_before = true}, work) && let_go(state, work, thrown_back)) return true;
  work.delta = work.trial;
  work.blows = work.mu_start;
  return false;
}

void LoopStepper::take_blow(LoopState& state, LoopWorkspace& work) const {
  note_reel_blows(state, work);
  for (std::size_t i = 0; i < work.fixed_jump.size(); ++i)
    work.fixed_jump[i] = state.fixed_velocity[i] - state.fixed_last_velocity[i];
  bool sound = true, again = true;
  for (bool first = true; again; first = false) {
    std::fill(work.delta.begin(), work.delta.end(), 0.0);
    swap_jumps(state, work);
    sound = project_soundly(state, {.jumps = true}, work);
    swap_jumps(state, work);
    again = (first && sound && release_thrown_back(state, work)) || let_go(state, work);
  }
  for (std::size_t i = 0; sound && i < state.u.size(); ++i) state.u[i] += work.delta[i];
}

void LoopStepper::find_velocities(LoopState& state, LoopWorkspace& work) const {
  const double step = state.u_step;
  std::fill(work.blows.begin(), work.blows.end(), 0.0);
  const double scale = step > 0 ? detail::exp(-drag_ * step / 2) / step : 1;
  const auto take_displacements = [&](double kick) {
    for (std::size_t i = 0; i < state.u.size(); ++i) {
      const bool falls = kick != 0 && !state.locks.has(static_cast<std::uint32_t>(i / 3));
      work.delta[i] = scale * state.u[i] + (falls ? kick * state.force[i] / state.weighs[i / 3] : 0);
    }
  };
  take_displacements(0);
  // The displacement of gradient new is the velocity at the end of its substep, and that of old is half a
  // substep earlier. Rods that gave do not say which velocities fit.
  if (step == 0 || state.gave) return;
  const double kick = gradient_ == Gradient::old ? mean_decay(drag_ * step / 2) * step / 2 : 0;
  if (kick != 0 && !state.grabs.empty()) hold_at_end(state, work);
  std::swap(state.fixed_velocity, state.fixed_last_velocity);  // fixed vertices went like that
  const bool sound = project_soundly(state, {.kick = kick}, work);
  std::swap(state.fixed_velocity, state.fixed_last_velocity);
  if (!sound) take_displacements(kick);
  state.changed.put_back();
}

void count_blows(LoopState& state, const LoopWorkspace& work) {
  if (!state.laws.pulls) return;
  for (std::size_t k = 0; k < state.topology->rods.size(); ++k)
    state.laws.impulse[k] -= work.blows[k] * std::sqrt(state.length2[k]) * state.mass_unit;
  hold_rod_blows(state, work);
  hold_blows(state, work);
  hold_reel_blows(state, work);
}

}  // namespace plumb::detail
