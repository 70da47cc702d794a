#pragma once

#include <optional>
#include <vector>

#include "direct/trial.hpp"

namespace plumb::bench {

/// The cheapest settings found that meet a target.
struct Answer {
  Target target;
  std::optional<Trial> fixed{};      ///< direct, gradient and substeps or accuracy chosen
  std::optional<Trial> mid{};        ///< the cheapest of those with gradient mid, as automatic with substeps
  std::optional<Trial> relaxed{};    ///< relax; none if nothing within `relax_cap` times `fixed` met it
  std::optional<Trial> automatic{};  ///< method automatic with accuracy
  std::optional<Trial> automatic_substeps{};  ///< method automatic with substeps
  std::vector<Trial> others{};  ///< further direct settings that meet it, cheap ones of either gradient

  /// The cheaper of fixed and relaxed, or null.
  const Trial* best() const;
};

/// How much work relaxation may take before it counts as beaten, in times of the cheapest direct setting.
inline constexpr double relax_cap = 4;

struct SearchLimits {
  double trial_s = 1;     ///< a direct run that takes longer is not followed by a finer one
  double retime_s = 0.2;  ///< for the last timing of a target's candidates
  bool relax = true;
};

/// Tries, in float and double, method direct with gradients old and mid, substeps doubling, frames of 1/60,
/// 1/30 and 1/20 s; direct and automatic with accuracies halving; automatic with substeps; and relaxation
/// with three gradients, five factors of over-relaxation, substeps and sweeps doubling. What meets a target
/// and seems cheapest is timed again by turns. Targets from the easiest to the hardest.
std::vector<Answer> search(const Problem& problem, const std::vector<Target>& targets,
                           const SearchLimits& limits);

/// What relaxation needs to come within `error`.
struct Effort {
  Trial last{};   ///< the best path's last run
  double ms = 0;  ///< per simulated second, measured or extrapolated
  bool extrapolated = false;
  double slope = 0;  ///< error falls as work to the power -slope, from the last two doublings
};

/// Relaxation in double, plain (omega 1) or over-relaxed: paths along which substeps double at a fixed number
/// of sweeps, and along which sweeps double at the fewest substeps that can do; each until a run takes
/// `first_s`, then the most promising until one takes `most_s`, and extrapolated from there.
Effort relax_effort(const Problem& problem, double error, bool over_relaxed, double first_s, double most_s);

/// What it takes to bring all rods of one frame of 1/60 s, one substep, within `stretch` of their length, in
/// the middle of the problem's motion: gradient mid, double. ms per frame.
struct FrameEffort {
  double direct_ms = 0, direct_stretch = 0;
  Effort plain{}, over{};  ///< `last.error` is the stretch that its last run left
};
FrameEffort frame_effort(const Problem& problem, double stretch, double most_s);

/// The cheapest direct setting, in double, with that error. `by_lines`: a net, which may keep 1e-6 of
/// stretch, too.
std::optional<Trial> direct_effort(const Problem& problem, double error, double most_s, bool by_lines);

}  // namespace plumb::bench
