#include "direct/loops/loop_stepper.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "direct/displacements/elastic_rods.hpp"
#include "direct/laws/change_share.hpp"
#include "direct/laws/held_rods.hpp"
#include "direct/laws/pulls_ahead.hpp"
#include "direct/loops/loop_newton.hpp"
#include "direct/loops/loop_vectors.hpp"
#include "direct/tackles/loop_pulleys.hpp"
#include "math/elementary.hpp"
#include "time/composition.hpp"
#include "time/progress.hpp"
#include "time/verlet.hpp"

namespace plumb::detail {
namespace {

constexpr int most_iterations = 36, most_factors = 12;
/// Where frames are bounded, iterations end that made no progress for so long. Of 60,000 tries of random
/// hangings that took mid, half of those that made none for six iterations were solved in the end.
constexpr int patience = 6;

/// Rods may add this share of what loads do in a substep, before a solution is taken for one of rounding
/// only.
constexpr double energy_tolerance = 1e-6;

/// Displacements below this share of a rod count as so much. What lines leave of lengths adds up along them.
constexpr double least_motion = 1e-6, least_motion_by_lines = 1e-3;

/// After a change this small, RMS over nodes relative to a rod, the next would be lost in rounding where
/// convergence is quadratic. The second may be left where convergence is linear.
constexpr double converged_change = 1e-8, converged_rest = 1e-17;

/// Redundant rods whose |C|/L^2 is larger do not fit together.
constexpr double most_misfit = 1e-8;

/// With an old factor the change must fall at least this fast, or a new one is made.
constexpr double slow_rate = 0.1;
/// With the factor of an earlier substep it must fall at least this fast, or the substep begins again with
/// one of its own.
constexpr double lost_rate = 0.5;

/// After so many substeps in a row for which lines were no help they are given up.
constexpr int most_stalls = 3;

/// A change of many rod lengths does not lead back.
constexpr double hopeless_change = 30;

/// Lets rigid cables that are hardly slack begin as taut ones (drawn_cable).
void draw_cables(LoopState& state) {
  for (std::uint32_t k = 0; k < state.topology->rods.size(); ++k)
    if (state.laws.is_rigid(k) && state.laws.is_one_sided(k))
      state.mu[k] = std::min(state.mu[k], -drawn_cable);
}

}  // namespace

/// u goes into a substep so many times, and force so many times (s^2).
struct LoopStepper::Coefficients {
  double ratio, kick;
};

/// They are as for trees.
auto LoopStepper::coefficients(const LoopState& state, double h, Gradient gradient) const -> Coefficients {
  if (gradient == Gradient::mid) return {detail::exp(-drag_ * h / 2) * h, 0.5 * h * h};
  if (gradient != gradient_ && state.u_step == 0)  // falls back from a velocity in flight, not from a start
    return {detail::exp(-drag_ * h) * h, mean_decay(drag_ * h) * h * h};
  const double last = state.u_step, between = (h + last) / 2;
  return {detail::exp(-drag_ * between) * (last != 0 ? h / last : h),
          mean_decay(drag_ * between) * h * between};
}

LoopStepper::LoopStepper(Gradient gradient, double drag, std::uint32_t time_order)
    : gradient_(gradient),
      drag_(drag),
      shares_(composition(time_order)),
      largest_share_(largest_share(time_order)) {}

/// Makes the load and the start of Newton's method: displacements and multipliers as they were, for this
/// substep's length.
void LoopStepper::begin(LoopState& state, double h, Gradient gradient, LoopWorkspace& work) const {
  const LoopTopology& shape = *state.topology;
  const auto [ratio, kick] = coefficients(state, h, gradient);
  work.laws.factors = LawFactors::of(gradient, kick, state.u_step, h, drag_);
  work.laws.is_mid = gradient == Gradient::mid;
  begin_grabs(state, {h, ratio, kick}, gradient, work);
  set_reel_lengths(state, h);
  if (state.laws.moves) set_substep_lengths(state.laws, h, state.length2);
  set_tackle_lengths(state, h, work.tackles);
  start_twists(state, h, work);
  std::copy(state.mu.begin(), state.mu.end(), work.mu_start.begin());
  const double scale = state.mu_kick != 0 ? kick / state.mu_kick : 0;
  for (double& mu : state.mu) mu *= scale;
  if (state.laws.any()) draw_cables(state);
  for (std::size_t i = 0; i < state.u.size(); ++i) {
    work.delta[i] = ratio * state.u[i];
    work.load[i] = state.mass[i / 3] * work.delta[i] + kick * state.force[i];
  }
  for (std::uint32_t k = 0; k < shape.rods.size(); ++k) {
    if (state.coupling[k] == 0) continue;
    const auto [a, b] = shape.rods[k];
    const bool fixed = b >= shape.nodes;
    const Vec3 before = fixed ? h * state.fixed_last_velocity[b - shape.nodes] : at(work.delta, b);
    put(&work.load[3 * a], at(work.load, a) + state.coupling[k] * before);
    if (!fixed) put(&work.load[3 * b], at(work.load, b) + state.coupling[k] * at(work.delta, a));
  }
  for (std::uint32_t i = shape.nodes; i < shape.vertices; ++i)
    put(&work.delta[3 * std::size_t{i}], h * state.fixed_velocity[i - shape.nodes]);
  move_locked(state, h, work.delta);
  start_reels(state, {h, ratio, kick}, work);
  start_pulleys(state, work);
}

/// Gradient mid keeps energy as far as rods keep their lengths. delta . (M delta - load) is what they did,
/// zero but for rounding. Where rods are nearly redundant, multipliers can be so large that it is not. Bends
/// and twists are loads too, since rods hold against them.
bool LoopStepper::keeps_energy(const LoopState& state, const LoopWorkspace& work) const {
  if (state.anchors_move) return true;
  const LoopTopology& shape = *state.topology;
  double done = 0, scale = 0;
  const double least = (work.lines ? least_motion_by_lines : least_motion) * std::sqrt(state.scale2);
  for (std::size_t i = 0; i < work.load.size(); ++i) {
    done += work.delta[i] * (state.mass[i / 3] * work.delta[i] - work.load[i]);
    scale += std::abs(work.load[i]) * (std::abs(work.delta[i]) + least);
  }
  for (std::uint32_t k = 0; k < shape.rods.size(); ++k) {
    const auto [a, b] = shape.rods[k];
    for (std::uint32_t c = 0; c < 3; ++c)
      done += 2 * state.coupling[k] * work.delta[3 * a + c] * work.delta[3 * b + c];
    if (state.laws.any() && state.laws.does_work(k)) {
      const Vec3 d = at(state.x, a) - at(state.x, b);  // lines do not write work.d
      done -= state.mu[k] * growth_of(d, at(work.delta, a) - at(work.delta, b)) / 2;
    }
  }
  done -= work_of_tackles(state, 0.5, work);
  for (const auto& of : {work_of_bends(state, work, least_motion), work_of_twists(state, work, least_motion)})
    done -= of.done, scale += of.scale;
  return std::abs(done) <= energy_tolerance * scale;
}

bool LoopStepper::iterate(LoopState& state, double h, Gradient gradient, bool carried, LoopWorkspace& work,
                          Tally& counters) const {
  const double theta = theta_of(gradient);
  LoopWorkspace::Factor& factor = work.factor(theta > 0);
  bool stale = !carried, converged = false, lost = false;
  double last = 0;
  int iterations = 0;
  ChangeShare share;
  Progress progress(patience);
  const bool bounded = is_bounded(state);
  measure_rods(state, work);
  bool switched = set_slides(state, theta, work);
  for (int factors = 0; iterations < most_iterations;) {
    const bool fresh = stale || switched || !has_same_cables(state, theta, work, factor);
    if (fresh) {
      if (factors++ == most_factors) break;
      factorize_newton(state, theta, 0, work, factor);
      factor.theta = theta;
      factor.h = h;
    }
    const double change = find_newton_change(state, theta, 0, work, factor);
    ++iterations;
    if (!(change <= hopeless_change) || (bounded && !progress.goes_on(change))) break;
    const double rate = last > 0 ? change / last : 1;
    // What an old factor finds is not taken where it hardly falls. It would spoil what the last one found.
    if (bounded && !fresh && rate > lost_rate && !(carried && factors == 0)) {
      stale = lost = true;
      continue;
    }
    // What is left of a change this small is rounding, which need not fall.
    const bool rises = fresh && change > converged_change;
    const double made = state.laws.any() ? share.next(rises ? rate : 0) : 1;
    apply_change(state, made, work, factor);
    switched = set_slides(state, theta, work);
    converged =
        made == 1 && !switched && change <= converged_change && (fresh || change * rate <= converged_rest);
    if (converged) break;
    if (carried && factors == 0 && last > 0 && rate > lost_rate) break;
    // Where an old factor led nowhere, the next ones do not either before changes fall.
    const bool falls = change <= slow_rate && (!lost || rate <= slow_rate);
    stale = fresh ? !falls : last > 0 && rate > slow_rate;
    last = change;
  }
  counters.newton += static_cast<std::uint64_t>(iterations);
  if (converged && largest_misfit(state, work, factor) <= most_misfit) return true;
  std::copy(work.mu_start.begin(), work.mu_start.end(), state.mu.begin());
  factor.h = 0;
  return false;
}

bool LoopStepper::solve_by_lines(LoopState& state, double h, Gradient gradient, LoopWorkspace& work,
                                 Tally& counters) const {
  begin(state, h, gradient, work);
  const double kick = coefficients(state, h, gradient).kick;
  const double tolerance = gradient == Gradient::mid ? finest_line_tolerance : line_tolerance_;
  const LineOutcome outcome = iterate_by_lines(state, theta_of(gradient), kick, tolerance, work, counters);
  if (outcome == LineOutcome::solved && (gradient != Gradient::mid || keeps_energy(state, work))) {
    work.lines->stalls = 0;
    return true;
  }
  std::copy(work.mu_start.begin(), work.mu_start.end(), state.mu.begin());
  if (outcome == LineOutcome::stalled && ++work.lines->stalls == most_stalls) work.lines.reset();
  return false;
}

bool LoopStepper::solve(LoopState& state, double h, Gradient gradient, bool by_lines, LoopWorkspace& work,
                        Tally& counters) const {
  const double theta = theta_of(gradient);
  if (work.lines && by_lines) {
    const int stalls = work.lines->stalls;
    if (solve_by_lines(state, h, gradient, work, counters)) return true;
    // A shorter substep is what helps lines that do not stall, and costs less than a factorisation.
    if (work.lines && work.lines->stalls == stalls) return false;
  }
  const bool by_net = work.net && by_lines;
  if (by_net || (state.topology->lines && theta > 0)) {
    if (work.lines) work.lines->forget();
    begin(state, h, gradient, work);
    const bool converged =
        by_net ? iterate_net(state, theta, work, counters)
               : iterate_by_displacements(state, theta, work.displacement_factor(), work, counters);
    if (converged && (gradient != Gradient::mid || keeps_energy(state, work))) return true;
    std::copy(work.mu_start.begin(), work.mu_start.end(), state.mu.begin());
    return false;
  }
  const LoopWorkspace::Factor& factor = work.factor(theta > 0);
  for (const bool carried : {true, false}) {
    if (carried && !(factor.worth_carrying() && factor.h == h && factor.theta == theta)) continue;
    begin(state, h, gradient, work);
    if (!iterate(state, h, gradient, carried, work, counters)) continue;
    if (gradient != Gradient::mid || keeps_energy(state, work)) return true;
    std::copy(work.mu_start.begin(), work.mu_start.end(), state.mu.begin());
    break;
  }
  return false;
}

namespace {

/// Notes how elastic cables have grown (LawWorkspace::growth).
void note_growth(const LoopState& state, LoopWorkspace& work) {
  work.laws.growth.resize(state.laws.rods.size());
  for (std::uint32_t k = 0; k < state.laws.rods.size(); ++k) {
    if (!state.laws.is_one_sided(k) || state.laws.is_rigid(k)) continue;
    const auto [a, b] = state.topology->rods[k];
    work.laws.growth[k] = growth_of(at(work.d, k), at(work.delta, a) - at(work.delta, b));
  }
}

}  // namespace

double LoopStepper::accept(LoopState& state, double h, Gradient gradient, LoopWorkspace& work,
                           Tally& counters) const {
  const auto [ratio, kick] = coefficients(state, h, gradient);
  // The change over two substeps is free of what mid swings by from one to the next. Half of it is that of
  // one, and h^2/12 times that is the error of position.
  double jolt = 0;
  for (std::size_t i = 0; i < state.acceleration.size(); ++i) {
    const double acceleration = (work.delta[i] - ratio * state.u[i]) / kick;
    const double change = acceleration - std::exchange(state.acceleration_before[i],
                                                       std::exchange(state.acceleration[i], acceleration));
    jolt += change * change;
  }
  const double error = state.known == 2 ? h * h / 24 * std::sqrt(jolt / state.topology->nodes) : 0;
  state.known = gradient == gradient_ ? std::min(state.known + 1, 2u) : 0;
  const double decay = detail::exp(-drag_ * h / 2);
  const double theta = theta_of(gradient);
  const SubstepEnd end{h, theta, kick, state.mass_unit, pulled_time(theta, h, state.u_step)};
  end_twists(state, end, work);
  hold_rods(state, end, work);
  for (std::size_t i = 0; i < state.x.size(); ++i) state.x[i] += work.delta[i];
  for (std::size_t i = 0; i < state.u.size(); ++i) {
    const double delta = work.delta[i];
    state.u[i] = gradient == Gradient::mid ? decay * (2 / h * delta - 1 / h * (ratio * state.u[i])) : delta;
  }
  end_tackles(state, end, work);
  hold_bends(state, end, work);
  note_growth(state, work);
  if (state.laws.any()) counters.broken_rods += end_rods(state.laws, work.laws, end, state.mu, state.length2);
  state.u_step = gradient == Gradient::mid ? 0 : h;
  state.mu_kick = kick;
  state.gave = false;
  end_grabs(state, {h, ratio, kick}, decay, work);
  move_locked(state, gradient == Gradient::mid ? 1 : h, state.u);
  // What follows in this step finds fixed vertices already on their way.
  if (state.anchors_move)
    std::copy(state.fixed_velocity.begin(), state.fixed_velocity.end(), state.fixed_last_velocity.begin());
  end_reels(state, end, work);
  if (gradient == Gradient::mid) stop_ringing(state, h, work);
  if (gradient == gradient_) return error;
  // u becomes a velocity, which every gradient can go on from.
  for (double& u : state.u) u /= h;
  state.u_step = 0;
  return error;
}

/// Gradient mid lets a velocity swing about zero where a cord begins to stick.
void LoopStepper::stop_ringing(LoopState& state, double h, LoopWorkspace& work) const {
  if (!begin_stop(state, h, work)) return;
  project_velocities(state, work);
  count_blows(state, work);
  end_blow(work.tackles);
}

bool LoopStepper::advance_elastic(LoopState& state, double h, LoopWorkspace& work, Tally& counters) const {
  begin(state, h, Gradient::new_, work);
  measure_rods(state, work);
  work.factor(true).h = 0;
  const Given given = let_rods_give(state, is_bounded(state), work, counters);
  if (given != Given::nothing) accept(state, h, Gradient::new_, work, counters);
  if (given == Given::rigid) {
    ++counters.direct_substeps;
    if (gradient_ != Gradient::new_) ++counters.fallbacks;
    return true;
  }
  ++counters.elastic_substeps;
  std::fill(state.mu.begin(), state.mu.end(), 0.0);
  state.gave = true;
  return false;
}

}  // namespace plumb::detail
