#include "contact/relaxed/relaxed_stepper.hpp"

#include <algorithm>
#include <chrono>

namespace plumb::detail {
namespace {

using Clock = std::chrono::steady_clock;

}  // namespace

template <class T>
void RelaxedStepper<T>::step(std::span<LinkageState* const> cluster, const Surroundings& surroundings,
                             const ClusterRules& rules, double dt, Tally& report) {
  const std::uint32_t substeps = rules.substeps;
  const double h = dt / substeps;
  recovery_rate_ = settings_.recovery / h;
  counts_ = std::any_of(cluster.begin(), cluster.end(),
                        [](const LinkageState* state) { return state->pulls.counts; });
  const double start = cluster.front()->elapsed;
  for (LinkageState* const state : cluster) state->elapsed += dt;
  ground_.find(surroundings, start);
  gather(cluster, surroundings, dt);
  for (std::uint32_t i = 0; i < substeps; ++i) {
    if (i > 0 && surroundings.any_moves()) ground_.find(surroundings, start + i * h);
    substep(cluster, surroundings, h, dt, report);
  }
  scatter(cluster);
}

template <class T>
void RelaxedStepper<T>::scatter(std::span<LinkageState* const> cluster) {
  for (std::uint32_t i = 0; i < cluster.size(); ++i) {
    crowd_.scatter(*cluster[i], i);
    if (crowd_.is_moving(i)) cluster[i]->follow_elastics();
  }
}

template <class T>
void RelaxedStepper<T>::gather(std::span<LinkageState* const> cluster, const Surroundings& surroundings,
                               double dt) {
  crowd_.gather(cluster, rules_);
  joints_.gather(cluster, crowd_);
  contacts_.find(cluster, crowd_, surroundings, ground_, dt, recovery_rate_);
}

template <class T>
void RelaxedStepper<T>::substep(std::span<LinkageState* const> cluster, const Surroundings& surroundings,
                                double h, double dt, Tally& report) {
  const Gradient asked = rules_.gradient == Gradient::old ? Gradient::mid : rules_.gradient;
  crowd_.predict(h, Gradient::new_);
  while (!contacts_.begin(cluster, crowd_, ground_, h)) {
    scatter(cluster);
    gather(cluster, surroundings, dt);
    crowd_.predict(h, Gradient::new_);
  }
  const bool is_new = !contacts_.is_empty() || joints_.has_elastics();
  const Gradient gradient = is_new ? Gradient::new_ : asked;
  if (gradient != Gradient::new_) crowd_.predict(h, gradient);
  crowd_.prepare(*kernels_);
  if (!joints_.are_empty()) scatter(cluster);
  joints_.begin(cluster, crowd_, h, recovery_rate_);
  solve(gradient, report);
  crowd_.advance(h, gradient);
  contacts_.bounce(crowd_);
  brake_joints(cluster, h);
  contacts_.end(cluster, crowd_, h);
  if (counts_) crowd_.count_pulls(h, gradient, cluster);
  report.broken_rods += joints_.end(cluster, crowd_, gradient == Gradient::mid ? 0.5 * h : h);
  report.contacts = std::max<std::uint64_t>(report.contacts, contacts_.count_pushes());
  for (std::uint32_t i = 0; i < cluster.size(); ++i) {
    if (!crowd_.is_moving(i) || !crowd_.stop_if_broken(*cluster[i], i)) continue;
    cluster[i]->kept.clear();
    cluster[i]->frozen = true;
    ++report.frozen_islands;
  }
}

template <class T>
void RelaxedStepper<T>::brake_joints(std::span<LinkageState* const> cluster, double h) {
  for (std::uint32_t i = 0; i < cluster.size(); ++i) {
    LinkageState& state = *cluster[i];
    if (state.linkage->joint_drag() == 0 || !crowd_.is_moving(i)) continue;
    crowd_.scatter(state, i);
    state.linkage->brake_joints(h, state.x, state.v, rigid_);
    crowd_.gather_velocities(state, i);
  }
}

template <class T>
void RelaxedStepper<T>::solve(Gradient gradient, Tally& report) {
  const StopRule& stop = rules_.stop;
  const double bound = stop.tolerance ? *stop.tolerance * (2 - std::min(*stop.tolerance, 1.0)) : 0;
  const auto deadline =
      Clock::now() + std::chrono::duration_cast<Clock::duration>(
                         std::chrono::duration<double, std::micro>(stop.budget_us.value_or(0)));
  std::uint32_t done = 0;
  StoppedBy reason = StoppedBy::sweeps;
  double left = INFINITY;
  while (done < stop.sweeps) {
    if (stop.tolerance && left <= *stop.tolerance * settings_.length_scale &&
        crowd_.violation(*kernels_) <= bound) {
      reason = StoppedBy::tolerance;
      break;
    }
    if (stop.budget_us && done > 0 && Clock::now() >= deadline) {
      reason = StoppedBy::budget;
      break;
    }
    crowd_.sweep(*kernels_, gradient, counts_);
    joints_.sweep(crowd_);
    left = contacts_.sweep(crowd_);
    ++done;
  }
  report.block_sweeps += done;
  report.rod_projections += std::uint64_t{done} * crowd_.rods();
  report.stopped_by = std::max(report.stopped_by, reason);
}

template class RelaxedStepper<float>;
template class RelaxedStepper<double>;

}  // namespace plumb::detail
