#include "tree_stepper.hpp"

#include <algorithm>
#include <cmath>

namespace plumb::detail {
namespace {

constexpr int most_iterations = 12;
constexpr int most_halvings = 10;

/// Newton's last change, RMS over particles relative to a rod, after which the next would be lost in
/// rounding: convergence is quadratic.
template <class T>
constexpr double converged_change = sizeof(T) == 8 ? 1e-8 : 1e-4;

/// A change of many rod lengths does not lead back.
constexpr double hopeless_change = 30;

double theta_of(Gradient gradient) {
  return gradient == Gradient::old ? 0 : gradient == Gradient::mid ? 0.5 : 1;
}

double mean_decay(double z) {
  return z > 1e-8 ? -std::expm1(-z) / z : 1 - z / 2;
}

}  // namespace

/// load = ratio M u + kick force
template <class T>
struct TreeStepper<T>::Coefficients {
  double ratio, kick;
};

template <class T>
TreeStepper<T>::TreeStepper(Gradient gradient, double drag, Isa isa)
    : gradient_(gradient),
      drag_(drag),
      vector_(simd::tree_kernels<T>(isa)),
      scalar_(simd::tree_kernels<T>(Isa::scalar)) {}

template <class T>
const simd::TreeKernels<T>& TreeStepper<T>::kernels(const TreeState<T>& state) const {
  return state.lanes == 1 ? scalar_ : vector_;
}

template <class T>
auto TreeStepper<T>::coefficients(const TreeState<T>& state, std::uint32_t lane, double h,
                                  Gradient gradient) const -> Coefficients {
  const double last = state.u_step[lane];
  if (gradient == Gradient::mid) return {std::exp(-drag_ * h / 2) * h, 0.5 * h * h};
  // Between the middles of the last substep and of this one, h/2 after the start for a velocity.
  const double between = (h + last) / 2;
  return {std::exp(-drag_ * between) * (last > 0 ? h / last : h), mean_decay(drag_ * between) * h * between};
}

template <class T>
void TreeStepper<T>::begin(TreeState<T>& state, std::uint32_t trees, double h, Gradient gradient,
                           TreeWorkspace<T>& work) const {
  const std::uint32_t lanes = state.lanes;
  std::copy_n(state.mu.data(), state.mu.size(), work.mu_start.data());
  std::copy_n(state.pin_mu.data(), state.pin_mu.size(), work.pin_mu_start.data());
  for (std::uint32_t lane = 0; lane < lanes; ++lane) {
    const auto [ratio, kick] = coefficients(state, lane, h, gradient);
    work.ratio[lane] = static_cast<T>(ratio);
    work.kick[lane] = static_cast<T>(kick);
    work.active[lane] = lane < trees ? T(1) : T(0);
    const T scale = state.mu_kick[lane] > 0 ? static_cast<T>(kick / state.mu_kick[lane]) : T(0);
    for (std::size_t i = lane; i < state.mu.size(); i += lanes) state.mu[i] *= scale;
    for (std::size_t i = lane; i < state.pin_mu.size(); i += lanes) state.pin_mu[i] *= scale;
  }
  if (state.pins_move) {
    for (std::size_t i = 0; i < state.pin_velocity.size(); ++i) {
      const std::size_t pin = i / lanes, lane = i % lanes;
      const Vec3 now = h * state.pin_velocity[i], last = h * state.pin_last_velocity[i];
      const double delta[3] = {now.x, now.y, now.z}, before[3] = {last.x, last.y, last.z};
      for (std::size_t c = 0; c < 3; ++c) {
        state.pin_delta[(3 * pin + c) * lanes + lane] = static_cast<T>(delta[c]);
        state.pin_u[(3 * pin + c) * lanes + lane] = static_cast<T>(before[c]);
      }
    }
  }
  for (std::size_t i = 0; i < state.u.size(); ++i) work.delta[i] = work.ratio[i % lanes] * state.u[i];
}

template <class T>
bool TreeStepper<T>::solve(TreeState<T>& state, std::uint32_t trees, Gradient gradient,
                           TreeWorkspace<T>& work, DirectCounters& counters) const {
  const simd::TreeView<T> view = work.view(state);
  const simd::TreeKernels<T>& run = kernels(state);
  run.prepare(view);
  const double nodes = state.topology->nodes;
  std::uint64_t iterations = 0;
  std::uint32_t left = trees;
  bool all = true;
  for (int i = 0; i < most_iterations && left > 0; ++i) {
    run.newton(view, static_cast<T>(theta_of(gradient)));
    iterations += left;
    for (std::uint32_t lane = 0; lane < trees; ++lane) {
      if (work.active[lane] == 0) continue;
      const double change = std::sqrt(work.change[lane] / (nodes * state.scale2[lane]));
      const bool converged = change <= converged_change<T>;
      if (!converged && change <= hopeless_change && i + 1 < most_iterations) continue;
      work.active[lane] = 0;
      work.failed[lane] = !converged;
      all = all && converged;
      --left;
    }
  }
  counters.newton.fetch_add(iterations, std::memory_order_relaxed);
  return all;
}

template <class T>
void TreeStepper<T>::accept(TreeState<T>& state, std::uint32_t lane, double h, Gradient gradient,
                            TreeWorkspace<T>& work) const {
  const std::uint32_t lanes = state.lanes;
  const T decay = static_cast<T>(std::exp(-drag_ * h / 2)), twice = static_cast<T>(2 / h);
  const T over = static_cast<T>(1 / h);
  for (std::size_t i = lane; i < state.u.size(); i += lanes) {
    const T delta = work.delta[i];
    state.x[i] += static_cast<double>(delta);
    state.u[i] =
        gradient == Gradient::mid ? decay * (twice * delta - over * (work.ratio[lane] * state.u[i])) : delta;
  }
  state.u_step[lane] = gradient == Gradient::mid ? 0 : h;
  state.mu_kick[lane] = static_cast<double>(work.kick[lane]);
  if (state.pins_move)
    for (std::size_t i = lane; i < state.pin_x.size(); i += lanes)
      state.pin_x[i] += static_cast<double>(state.pin_delta[i]);
}

template <class T>
void TreeStepper<T>::restore(TreeState<T>& state, std::uint32_t lane, TreeWorkspace<T>& work) const {
  for (std::size_t i = lane; i < state.mu.size(); i += state.lanes) state.mu[i] = work.mu_start[i];
  for (std::size_t i = lane; i < state.pin_mu.size(); i += state.lanes)
    state.pin_mu[i] = work.pin_mu_start[i];
}

template <class T>
bool TreeStepper<T>::advance_alone(TreeState<T>& state, double h, int depth, TreeWorkspace<T>& work,
                                   DirectCounters& counters) const {
  for (const Gradient gradient : {gradient_, Gradient::new_}) {
    if (gradient != gradient_ && depth < most_halvings) break;
    begin(state, 1, h, gradient, work);
    if (solve(state, 1, gradient, work, counters)) {
      accept(state, 0, h, gradient, work);
      counters.substeps.fetch_add(1, std::memory_order_relaxed);
      if (gradient != gradient_) {
        counters.fallbacks.fetch_add(1, std::memory_order_relaxed);
        // As a velocity, which every gradient can go on from.
        for (std::size_t i = 0; i < state.u.size(); ++i) state.u[i] = static_cast<T>(state.u[i] / h);
        state.u_step[0] = 0;
      }
      return true;
    }
    restore(state, 0, work);
  }
  if (depth == most_halvings) return false;
  counters.halvings.fetch_add(1, std::memory_order_relaxed);
  return advance_alone(state, h / 2, depth + 1, work, counters) &&
         advance_alone(state, h / 2, depth + 1, work, counters);
}

template <class T>
void TreeStepper<T>::advance(TreeState<T>& state, std::uint32_t trees, double h, TreeWorkspace<T>& work,
                             TreeState<T>& alone, TreeWorkspace<T>& alone_work,
                             DirectCounters& counters) const {
  begin(state, trees, h, gradient_, work);
  solve(state, trees, gradient_, work, counters);
  for (std::uint32_t lane = 0; lane < trees; ++lane) {
    if (!work.failed[lane]) {
      accept(state, lane, h, gradient_, work);
      counters.substeps.fetch_add(1, std::memory_order_relaxed);
      continue;
    }
    restore(state, lane, work);
    counters.halvings.fetch_add(1, std::memory_order_relaxed);
    alone.copy_lane(0, state, lane);
    if (advance_alone(alone, h / 2, 1, alone_work, counters) &&
        advance_alone(alone, h / 2, 1, alone_work, counters)) {
      state.copy_lane(lane, alone, 0);
    } else {
      counters.unsolved.fetch_add(1, std::memory_order_relaxed);
    }
  }
}

template <class T>
void TreeStepper<T>::project(TreeState<T>& state, TreeWorkspace<T>& work) const {
  std::fill_n(work.ratio.data(), work.ratio.size(), T(0));
  for (std::size_t i = 0; i < state.pin_velocity.size(); ++i) {
    const std::size_t pin = i / state.lanes, lane = i % state.lanes;
    const Vec3 v = state.pin_velocity[i];
    const double velocity[3] = {v.x, v.y, v.z};
    for (std::size_t c = 0; c < 3; ++c)
      state.pin_delta[(3 * pin + c) * state.lanes + lane] = static_cast<T>(velocity[c]);
  }
  const simd::TreeView<T> view = work.view(state);
  kernels(state).prepare(view);
  kernels(state).project(view);
  std::fill_n(state.pin_delta.data(), state.pin_delta.size(), T(0));
}

template <class T>
void TreeStepper<T>::project_velocities(TreeState<T>& state, TreeWorkspace<T>& work) const {
  std::copy_n(state.u.data(), state.u.size(), work.delta.data());
  std::fill_n(work.kick.data(), work.kick.size(), T(0));
  std::fill_n(work.active.data(), work.active.size(), T(1));
  project(state, work);
  std::copy_n(work.delta.data(), state.u.size(), state.u.data());
}

template <class T>
void TreeStepper<T>::find_velocities(TreeState<T>& state, TreeWorkspace<T>& work) const {
  bool any = false;
  for (std::uint32_t lane = 0; lane < state.lanes; ++lane) {
    const double step = state.u_step[lane];
    const bool displacements = step > 0;
    any = any || displacements;
    const T scale = displacements ? static_cast<T>(std::exp(-drag_ * step / 2) / step) : T(1);
    for (std::size_t i = lane; i < state.u.size(); i += state.lanes) work.delta[i] = scale * state.u[i];
    // The displacement of gradient new is the velocity at the end of its substep, that of old half a substep
    // earlier.
    work.kick[lane] = gradient_ == Gradient::old && displacements ? static_cast<T>(step / 2) : T(0);
    work.active[lane] = displacements ? T(1) : T(0);
  }
  if (any) project(state, work);
}

template class TreeStepper<float>;
template class TreeStepper<double>;

}  // namespace plumb::detail
