// This file sweeps a substep of a cluster.

#include <algorithm>
#include <chrono>
#include <cmath>

#include "contact/relaxed/relaxed_stepper.hpp"

namespace plumb::detail {
namespace {

using Clock = std::chrono::steady_clock;

/// After a blow sweeps go on until rods fit, at most so often.
constexpr std::uint32_t most_hit_sweeps = 400;
/// Contacts alone are visited at most so often more, so that what sweeps leave is not in the ground.
constexpr std::uint32_t most_presses = 50;
/// Sweeps have momentum after so many at once: to go on takes a fifth of a sweep.
constexpr std::uint32_t sweeps_together = 2;

}  // namespace

/// Returns whether sweeps have momentum. What joints and contacts alone have pushed does not go on.
template <class T>
bool RelaxedStepper<T>::begin_momentum() {
  swept_.assign({crowd_.swept()});
  if (counts_) swept_.push_back(crowd_.counted());
  if (rules_.step_sweeps == 0 || !joints_.are_empty() || !contacts_.list_swept(swept_)) return false;
  momentum_.begin(swept_);
  return true;
}

/// Sweeps once over what holds islands together.
template <class T>
void RelaxedStepper<T>::sweep_held(Gradient gradient) {
  crowd_.sweep(rod_kernels(), gradient, counts_);
  joints_.sweep(crowd_);
  bodies_.right(crowd_);
}

template <class T>
void RelaxedStepper<T>::solve(Gradient gradient, Tally& report) {
  const StopRule& stop = rules_.stop;
  const double most = stop.tolerance ? *stop.tolerance * (2 - std::min(*stop.tolerance, 1.0)) : 0;
  const double kept = crowd_.most_kept(), bound = kept < most ? most - kept : most;
  const auto deadline =
      Clock::now() + std::chrono::duration_cast<Clock::duration>(
                         std::chrono::duration<double, std::micro>(stop.budget_us.value_or(0)));
  std::uint32_t done = 0;
  StoppedBy reason = StoppedBy::sweeps;
  double left = INFINITY;
  begin_rigidly();
  const bool has_momentum = begin_momentum();
  while (done < most_sweeps_) {
    if (stop.tolerance && left <= *stop.tolerance * settings_.length_scale &&
        crowd_.violation(rod_kernels()) <= bound) {
      reason = kept < most ? StoppedBy::tolerance : StoppedBy::sweeps;
      break;
    }
    if (stop.budget_us && done > 0 && Clock::now() >= deadline) {
      reason = StoppedBy::budget;
      break;
    }
    sweep_held(gradient);
    if (stop.tolerance)
      left = contacts_.measured_sweep(crowd_, team_);
    else
      contacts_.sweep(crowd_, team_);
    ++done;
    if (has_momentum && done % sweeps_together == 0 && done < most_sweeps_) momentum_.go_on(swept_);
  }
  contacts_.end_sweeps();
  if (is_hit_ || is_struck()) done += sweep_on(gradient);
  bodies_.right(crowd_);
  is_in_ground_ = contacts_.leave_ground(crowd_);
  report.block_sweeps += done;
  report.rod_projections += std::uint64_t{done} * crowd_.rods();
  report.stopped_by = std::max(report.stopped_by, reason);
}

/// Sweeps on after a blow, until rods fit and nothing is in anything. Returns how often.
template <class T>
std::uint32_t RelaxedStepper<T>::sweep_on(Gradient gradient) {
  const double most = most_violated(), deepest = is_hit_ ? settings_.tolerance : settings_.margin;
  std::uint32_t done = 0;
  for (; done < most_hit_sweeps && crowd_.violation(rod_kernels()) > most; ++done) {
    sweep_held(gradient);
    contacts_.sweep(crowd_, team_);
  }
  const std::uint32_t presses = is_hit_ ? most_presses : std::min(most_presses, most_sweeps_);
  for (std::uint32_t i = 0; i < presses && contacts_.depth(crowd_) > deepest; ++i)
    contacts_.sweep(crowd_, team_);
  contacts_.end_sweeps();
  return done;
}

template bool RelaxedStepper<float>::begin_momentum();
template void RelaxedStepper<float>::sweep_held(Gradient);
template void RelaxedStepper<float>::solve(Gradient, Tally&);
template std::uint32_t RelaxedStepper<float>::sweep_on(Gradient);
template bool RelaxedStepper<double>::begin_momentum();
template void RelaxedStepper<double>::sweep_held(Gradient);
template void RelaxedStepper<double>::solve(Gradient, Tally&);
template std::uint32_t RelaxedStepper<double>::sweep_on(Gradient);

}  // namespace plumb::detail
