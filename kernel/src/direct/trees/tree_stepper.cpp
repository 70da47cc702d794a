#include "direct/trees/tree_stepper.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include "direct/attempts/elastic_tree.hpp"
#include "direct/laws/held_rods.hpp"
#include "direct/laws/tree_rods.hpp"
#include "direct/trees/newton_guess.hpp"
#include "direct/trees/newton_limits.hpp"
#include "math/elementary.hpp"
#include "time/composition.hpp"
#include "time/progress.hpp"
#include "time/verlet.hpp"

namespace plumb::detail {
using namespace tree_limits;

/// With these, load = ratio M u + kick force, and u becomes u_delta delta - u_before ratio u.
template <class T>
struct TreeStepper<T>::Coefficients {
  double ratio, kick, u_delta, u_before;
};

template <class T>
TreeStepper<T>::TreeStepper(Gradient gradient, double drag, bool estimates, Isa isa, std::uint32_t time_order)
    : gradient_(gradient),
      drag_(drag),
      estimates_(estimates),
      shares_(composition(time_order)),
      largest_share_(largest_share(time_order)),
      vector_(simd::tree_kernels<T>(isa)),
      scalar_(simd::tree_kernels<T>(Isa::scalar)) {}

template <class T>
const simd::TreeKernels<T>& TreeStepper<T>::kernels(const TreeState<T>& state) const {
  return state.lanes == 1 ? scalar_ : vector_;
}

template <class T>
auto TreeStepper<T>::coefficients(double last, double h, Gradient gradient) const -> Coefficients {
  if (gradient == Gradient::mid) {
    const double decay = drag_ > 0 ? detail::exp(-drag_ * h / 2) : 1;
    return {decay * h, 0.5 * h * h, 2 * decay / h, decay / h};
  }
  if (gradient != gradient_ && last == 0) {  // it falls back from a velocity in mid-flight, not from a start
    const double decay = drag_ > 0 ? detail::exp(-drag_ * h) : 1;
    return {decay * h, mean_decay(drag_ * h) * h * h, 1, 0};
  }
  // The time is from the middle of the last substep, or from its end if u is a velocity, to the middle of
  // this one.
  const double between = (h + last) / 2;
  return {(drag_ > 0 ? detail::exp(-drag_ * between) : 1) * (last != 0 ? h / last : h),
          mean_decay(drag_ * between) * h * between, 1, 0};
}

template <class T>
void TreeStepper<T>::begin(TreeState<T>& state, double h, Gradient gradient, TreeWorkspace<T>& work) const {
  Coefficients of_lane{};  // these are mostly the same in all, and exp() is dear
  LawFactors of_laws;
  for (std::uint32_t lane = 0; lane < state.lanes; ++lane) {
    if (lane == 0 || state.u_step[lane] != state.u_step[lane - 1]) {
      of_lane = coefficients(state.u_step[lane], h, gradient);
      if (state.laws.gives) of_laws = LawFactors::of(gradient, of_lane.kick, state.u_step[lane], h, drag_);
    }
    const auto& [ratio, kick, u_delta, u_before] = of_lane;
    work.ratio[lane] = static_cast<T>(ratio);
    work.kick[lane] = static_cast<T>(kick);
    // The acceleration of gradient mid carries an undamped oscillation of period 2h. Means of two are free of
    // it.
    const bool mean = gradient == Gradient::mid;
    work.guess[lane] = state.smooth[lane] ? static_cast<T>(mean ? kick / 2 : kick) : T(0);
    work.guess_before[lane] = state.smooth[lane] && mean ? static_cast<T>(kick / 2) : T(0);
    work.inverse_kick[lane] = static_cast<T>(1 / kick);
    work.u_delta[lane] = static_cast<T>(u_delta);
    work.u_before[lane] = static_cast<T>(u_before);
    const auto [scale, scale_before] = multiplier_scales(state, lane, kick, gradient);
    work.mu_scale[lane] = static_cast<T>(scale);
    work.mu_scale_before[lane] = static_cast<T>(scale_before);
    work.active[lane] = state.idle[lane] ? T(0) : T(1);
    if (state.laws.gives) state.laws.set_factors(lane, of_laws);
  }
  work.is_mid = gradient == Gradient::mid;
  work.keeps_half_kicks = gradient_ == Gradient::old;
  if (state.ties_move) set_tie_displacements(state, h, work);
  if (state.laws.moves) set_substep_lengths(state, h);
  if (state.bends.any()) begin_bends(state, h, work);
  start_twists(state, h, work);
  if (state.grabs.any()) begin_grabs(state, h, gradient, work);
  work.is_line = is_line(state, gradient);
  work.keeps_acceleration = estimates_ || !work.is_line;
  kernels(state).prepare(work.view(state));
  if (state.laws.cables) draw_cables(state);
  state.laws.steps_are_old = false;
}

template <class T>
void TreeStepper<T>::put_ties(TreeState<T>& state, std::size_t i, Vec3 delta, Vec3 u) const {
  const std::size_t lanes = state.lanes, first = i / lanes * 3 * lanes + i % lanes;
  state.tie_delta[first] = static_cast<T>(delta.x);
  state.tie_delta[first + lanes] = static_cast<T>(delta.y);
  state.tie_delta[first + 2 * lanes] = static_cast<T>(delta.z);
  state.tie_u[first] = static_cast<T>(u.x);
  state.tie_u[first + lanes] = static_cast<T>(u.y);
  state.tie_u[first + 2 * lanes] = static_cast<T>(u.z);
}

template <class T>
void TreeStepper<T>::set_tie_displacements(TreeState<T>& state, double h,
                                           const TreeWorkspace<T>& work) const {
  for (std::size_t i = 0; i < state.tie_velocity.size(); ++i) {
    // What comes before goes into the load as the tree's own u does, drag included.
    const std::size_t lane = i % state.lanes;
    const double ratio = static_cast<double>(work.ratio[lane]), step = state.u_step[lane];
    put_ties(state, i, h * state.tie_velocity[i],
             ratio * (step != 0 ? step : 1) * state.tie_last_velocity[i]);
  }
}

template <class T>
bool TreeStepper<T>::solve(TreeState<T>& state, Gradient gradient, TreeWorkspace<T>& work,
                           Tally& counters) const {
  const simd::TreeView<T> view = work.view(state);
  const simd::TreeKernels<T>& run = kernels(state);
  const double nodes = state.topology->nodes;
  const bool line = is_line(state, gradient);
  std::uint64_t iterations = 0;
  std::uint32_t left = state.trees;
  bool all = true;
  const bool bounded = bounds_frames_ && !state.bends.any();
  const int unbounded = state.bends.any() ? most_bent_iterations : most_iterations;
  const int most = bounded ? most_bounded_iterations : unbounded;
  const double farthest = bounded ? hopeless_bounded_change : hopeless_change;
  std::array<Progress, simd::logical_width<float>> progress;
  progress.fill(Progress(bounded ? bounded_patience : most));
  for (int i = 0; i < most && left > 0; ++i) {
    if (line) {
      run.newton_line(view);
    } else {
      run.newton(view, static_cast<T>(theta_of(gradient)));
    }
    iterations += left;
    for (std::uint32_t lane = 0; lane < state.lanes; ++lane) {
      if (work.active[lane] == 0) continue;
      const double scale2 = state.scale2[lane], change2 = work.change[lane] / nodes;
      const bool converged = has_converged<T>(change2, work.residual[lane], scale2, gradient);
      if (!converged && !is_hopeless(change2, scale2, farthest) && i + 1 < most &&
          progress[lane].goes_on(std::sqrt(change2)))
        continue;
      work.active[lane] = 0;
      work.failed[lane] = !converged;
      work.iterations[lane] = static_cast<std::uint32_t>(i + 1);
      all = all && converged;
      --left;
    }
  }
  counters.newton += iterations;
  return all;
}

template <class T>
void TreeStepper<T>::accept(TreeState<T>& state, double h, Gradient gradient, TreeWorkspace<T>& work,
                            Tally& counters) const {
  for (std::uint32_t lane = 0; lane < state.lanes; ++lane) {
    const bool skipped = state.idle[lane] || work.failed[lane];
    work.active[lane] = skipped ? T(0) : T(1);
    if (skipped) continue;
    state.gave[lane] = 0;
    state.u_step_before[lane] = state.u_step[lane];
    state.u_step[lane] = gradient == Gradient::mid ? 0 : h;
    state.mu_kick_before[lane] = state.mu_kick[lane];
    state.mu_kick[lane] = static_cast<double>(work.kick[lane]);
    state.known[lane] = static_cast<std::uint8_t>(std::min(state.known[lane] + 1, 2));
    if (!state.ties_move) continue;
    for (std::size_t i = lane; i < state.tie_x.size(); i += state.lanes)
      state.tie_x[i] += static_cast<double>(state.tie_delta[i]);
    for (std::size_t i = lane; i < state.tie_velocity.size(); i += state.lanes)
      state.tie_last_velocity[i] = state.tie_velocity[i];
  }
  kernels(state).advance(work.view(state));
  if (state.grabs.any()) end_grabs(state, h, gradient, drag_, work);
  if (const auto& laws = state.laws; laws.moves || laws.pulls || laws.breaks)
    counters.broken_rods += end_rods(state, h, theta_of(gradient), work);
  hold_rods(state, h, theta_of(gradient), work);
  end_twists(state, h, theta_of(gradient), work);
  if (state.bends.any() && state.laws.pulls) hold_bends(state, h, theta_of(gradient), work);
  for (std::uint32_t lane = 0; lane < state.lanes; ++lane)
    if (!state.idle[lane] && !work.failed[lane] && work.keeps_acceleration)
      state.smooth[lane] = work.jolt[lane] < 4 * smooth_jolt * work.push[lane];
}

template <class T>
void TreeStepper<T>::restore_multipliers(TreeState<T>& state, std::uint32_t lane) const {
  for (std::size_t i = lane; i < state.mu.size(); i += state.lanes) state.mu[i] = state.mu_before[i];
  for (std::size_t i = lane; i < state.tie_mu.size(); i += state.lanes)
    state.tie_mu[i] = state.tie_mu_before[i];
  state.mu_kick_before[lane] = 0;  // those before the last are lost
}

template <class T>
template <class Load>
auto TreeStepper<T>::rescue(double h, const TreeCrew<T>& crew, Tally& counters, Load&& load) const -> Rescue {
  TreeState<T>& alone = crew.alone.get();
  double rest = h;
  load();
  if (alone.bends.any() && crew.elastic != nullptr) {  // bends may start far from where they end
    crew.elastic->advance_as_island(alone, h, counters);
    return Rescue::halves;
  }
  const bool again = alone.elastic[0] > 0;
  if (!again) {
    ++counters.halvings;
    Attempts attempts{most_attempts,
                      counters.newton + (bounds_frames_ ? alone.effort[0].most() : Effort::endless)};
    if (advance_in_pieces(alone, h, attempts, crew.alone_work, counters)) return Rescue::halves;
    if (bounds_frames_)
      rest = (1 - attempts.done) * h;  // what was solved stands
    else
      load();
    alone.elastic[0] = std::max(alone.next_elastic[0], elastic_substeps);
    alone.next_elastic[0] = std::min(2 * alone.elastic[0], most_elastic_substeps);
  }
  const std::uint32_t elastic = alone.elastic[0] - 1, next_elastic = alone.next_elastic[0];
  // Where frames are bounded, rods that give come to the same end by a shorter way. Gradient new finds a line
  // just long enough after some substeps, though.
  const bool is_short = bounds_frames_ && crew.elastic != nullptr && !again;
  const bool tries_new = gradient_ != Gradient::new_ && !is_short;
  Rescue rescued = Rescue::elastic;
  if (tries_new && advance_damped(alone, rest, damped_halvings, crew.alone_work, counters)) {
    rescued = Rescue::halves;
  } else if (crew.elastic != nullptr) {
    if (tries_new) load();
    crew.elastic->advance(alone, rest, counters);
  } else {
    ++counters.unsolved;
    return Rescue::none;
  }
  alone.elastic[0] = elastic;
  alone.next_elastic[0] = next_elastic;
  return rescued;
}

template <class T>
std::uint32_t TreeStepper<T>::cuts(const TreeState<T>& state, double h) const {
  if (gradient_ != Gradient::old) return 1;
  return pieces_of(largest_share_ * h * std::sqrt(state.frequency2) / aimed_frequency, most_pieces);
}

template <class T>
std::uint32_t TreeStepper<T>::bounded_cuts(const TreeState<T>& state, double h, Tally& counters) const {
  const std::uint32_t count = cuts(state, h);
  return count > most_spent_pieces && counters.is_spent() ? most_spent_pieces : count;
}

template <class T>
bool TreeStepper<T>::is_stable(TreeState<T>& state, double h, TreeWorkspace<T>& work,
                               const LineSegments* segments) const {
  kernels(state).find_stiffness(work.view(state));
  if (segments) segments->join_stiffness(state, work);
  double largest = 0;
  bool stable = true;
  for (std::uint32_t lane = 0; lane < state.lanes; ++lane) {
    if (state.idle[lane] || work.failed[lane]) continue;
    const double frequency2 =
        static_cast<double>(work.stiffness[lane]) / std::abs(static_cast<double>(work.kick[lane]));
    largest = std::max(largest, frequency2);
    if (h * h * frequency2 <= highest_frequency * highest_frequency) continue;
    work.failed[lane] = 1;
    stable = false;
  }
  state.frequency2 = largest;
  return stable;
}

template <class T>
double TreeStepper<T>::advance(TreeState<T>& state, double h, const TreeCrew<T>& crew,
                               Tally& counters) const {
  double error = 0;
  const std::uint32_t count = bounded_cuts(state, h, counters);
  for (std::uint32_t i = 0; i < count; ++i)
    for (const double share : shares_of(state))
      error += advance_piece(state, share * h / count, crew, counters);
  return error;
}

template <class T>
double TreeStepper<T>::advance_piece(TreeState<T>& state, double h, const TreeCrew<T>& crew,
                                     Tally& counters) const {
  TreeWorkspace<T>& work = crew.work;
  begin(state, h, gradient_, work);
  bool all = solve(state, gradient_, work, counters);
  if (gradient_ == Gradient::old) all = is_stable(state, h, work) && all;
  double error = 0;
  for (std::uint32_t lane = 0; lane < state.lanes; ++lane) work.first[lane] = state.known[lane] < 2;
  accept(state, h, gradient_, work, counters);
  for (std::uint32_t lane = 0; estimates_ && lane < state.lanes; ++lane) {
    if (state.idle[lane]) continue;
    const double jolt = std::sqrt(work.jolt[lane] / state.topology->nodes) / 2;
    if (!work.failed[lane] && !work.first[lane]) error = std::max(error, h * h / 12 * jolt);
  }
  for (std::uint32_t lane = 0; lane < state.lanes; ++lane)
    if (!state.idle[lane] && !work.failed[lane]) state.effort[lane].took(work.iterations[lane]);
  counters.direct_substeps += state.trees;
  for (std::uint32_t lane = 0; !all && lane < state.lanes; ++lane) {
    if (state.idle[lane] || !work.failed[lane]) continue;
    error = std::numeric_limits<double>::infinity();
    --counters.direct_substeps;
    restore_multipliers(state, lane);
    const std::uint64_t before = counters.newton - work.iterations[lane];  // rescue may work there, too
    TreeState<T>& alone = crew.alone.get();
    const Rescue rescued = rescue(h, crew, counters, [&] { alone.copy_lane(0, state, lane); });
    if (rescued != Rescue::none) state.copy_lane(lane, alone, 0);
    if (rescued != Rescue::halves) state.frequency2 = 0;  // it was made of multipliers that solve nothing
    state.effort[lane].took(counters.newton - before);
  }
  return error;
}

template <class T>
double TreeStepper<T>::advance(const LineSegments& segments, TreeState<T>& state, double h,
                               const TreeCrew<T>& crew, Tally& counters) const {
  double error = 0;
  const std::uint32_t count = bounded_cuts(state, h, counters);
  for (std::uint32_t i = 0; i < count; ++i)
    for (const double share : shares_of(state))
      error += advance_piece(segments, state, share * h / count, crew, counters);
  return error;
}

template <class T>
double TreeStepper<T>::advance_piece(const LineSegments& segments, TreeState<T>& state, double h,
                                     const TreeCrew<T>& crew, Tally& counters) const {
  TreeWorkspace<T>& work = crew.work;
  TreeState<T>& alone = crew.alone.get();
  const double nodes = alone.topology->nodes, scale2 = state.scale2[0];
  const auto total = [&](std::span<const T> lanes) {
    double sum = 0;
    for (std::uint32_t lane = 0; lane < state.lanes; ++lane) sum += static_cast<double>(lanes[lane]);
    return sum;
  };
  segments.link(state);
  begin(state, h, gradient_, work);
  segments.trim(work);
  const simd::TreeView<T> view = work.view(state);
  double change2 = 0;
  bool converged = false;
  for (int i = 0; i < most_iterations && !converged && !is_hopeless(change2, scale2); ++i) {
    vector_.newton_segments(view);
    change2 = total(work.change) / nodes;
    converged = has_converged<T>(change2, total(work.residual), scale2, gradient_);
    ++counters.newton;
  }
  std::fill(work.failed.begin(), work.failed.end(), std::uint8_t{0});
  if (converged && is_stable(state, h, work, &segments)) {
    const bool first = state.known[0] < 2;
    accept(state, h, gradient_, work, counters);
    ++counters.direct_substeps;
    return estimates_ && !first ? h * h / 24 * std::sqrt(total(work.jolt) / nodes) : 0;
  }
  state.grabs.put_back();
  for (std::uint32_t lane = 0; lane < state.lanes; ++lane) restore_multipliers(state, lane);
  const Rescue rescued = rescue(h, crew, counters, [&] { segments.gather(state, alone); });
  if (rescued != Rescue::none) segments.scatter(alone, state);
  if (rescued != Rescue::halves) state.frequency2 = 0;
  return std::numeric_limits<double>::infinity();
}

template class TreeStepper<float>;
template class TreeStepper<double>;

}  // namespace plumb::detail
