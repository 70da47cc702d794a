#pragma once

#include <cmath>
#include <cstdint>
#include <utility>

#include "direct/trees/tree_state.hpp"
#include "plumb/settings.hpp"

/// Newton's method on a tree starts from what the last substeps found.
namespace plumb::detail::tree_limits {

/// Below this (change of acceleration)^2 over acceleration^2 it pays to start Newton from the last
/// acceleration. Above, it starts farther off than without.
inline constexpr double smooth_jolt = 0.05;

/// Multipliers are extrapolated over at most so many times the time between the two they are made of. Where
/// an accuracy chooses steps, they double at most.
inline constexpr double most_extrapolated = 2;

/// Returns what factors of the last multipliers and of those before go into a first guess. For gradient old
/// -mu/kick is a tension over a length where a substep starts. The last two are u_step_before apart, and the
/// next comes u_step later. Both are negative in parts of compositions. Gradient mid's swing from one substep
/// to the next, so they are carried on.
template <class T>
std::pair<double, double> multiplier_scales(const TreeState<T>& state, std::uint32_t lane, double kick,
                                            Gradient gradient) {
  const double last = state.mu_kick[lane], before = state.mu_kick_before[lane];
  if (last == 0) return {0, 0};
  const double step = state.u_step[lane], step_before = state.u_step_before[lane];
  const bool extrapolates = gradient == Gradient::old && before != 0 && step != 0 &&
                            std::abs(step) <= most_extrapolated * std::abs(step_before);
  if (!extrapolates) return {kick / last, 0};
  const double step_ratio = step / step_before;
  return {(1 + step_ratio) * kick / last, -step_ratio * kick / before};
}

}  // namespace plumb::detail::tree_limits
