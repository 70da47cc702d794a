#pragma once

#include <optional>
#include <vector>

#include "direct/trial.hpp"

namespace plumb::bench {

/// Holds the cheapest settings found that meet a target.
struct Answer {
  Target target;
  std::optional<Trial> fixed{};  ///< direct with a gradient and substeps or an accuracy
  std::optional<Trial>
      mid{};  ///< the cheapest of those with gradient mid, which automatic takes with substeps
  std::optional<Trial> relaxed{};  ///< relax; none if nothing within `relax_cap` times `fixed` met the target
  std::optional<Trial> automatic{};           ///< method automatic with accuracy
  std::optional<Trial> automatic_substeps{};  ///< method automatic with substeps
  std::vector<Trial>
      others{};  ///< further direct settings that meet the target, cheap ones of either gradient

  /// Returns the cheaper of fixed and relaxed, or null.
  const Trial* best() const;
};

/// Relaxation counts as beaten above this many times the work of the cheapest direct setting. A larger value
/// searches longer.
inline constexpr double relax_cap = 4;

struct SearchLimits {
  double trial_s = 1;     ///< a direct run that takes longer is not followed by a finer one
  double retime_s = 0.2;  ///< seconds for the last timing of a target's candidates
  bool relax = true;
};

/// Tries many settings in float and double:
///
/// - method direct with gradients old and mid, substeps doubling, frames of 1/60, 1/30 and 1/20 s;
/// - methods direct and automatic with accuracies halving, and automatic with substeps;
/// - relaxation with three gradients, five factors of over-relaxation, substeps and sweeps doubling.
///
/// What meets a target and seems cheapest is timed again by turns. Targets go from the easiest to the
/// hardest.
std::vector<Answer> search(const Problem& problem, const std::vector<Target>& targets,
                           const SearchLimits& limits);

/// Holds what relaxation needs to come within `error`.
struct Effort {
  Trial last{};   ///< the best path's last run
  double ms = 0;  ///< ms per simulated second, measured or extrapolated
  bool extrapolated = false;
  double slope = 0;  ///< error falls as work to the power -slope, from the last two doublings
};

/// Searches relaxation in double, plain (omega 1) or over-relaxed. Along some paths substeps double at a
/// fixed number of sweeps. Along others sweeps double at the fewest substeps that can do.
///
/// Each path goes on until a run takes `first_s` (s). The most promising goes on until a run takes `most_s`,
/// and is extrapolated from there.
Effort relax_effort(const Problem& problem, double error, bool over_relaxed, double first_s, double most_s);

/// Holds what it takes (ms per frame) to bring all rods of one frame within `stretch` of their length. The
/// frame is 1/60 s in one substep, in the middle of the problem's motion, with gradient mid in double.
struct FrameEffort {
  double direct_ms = 0, direct_stretch = 0;
  Effort plain{}, over{};  ///< `last.error` is the stretch that its last run left
};
FrameEffort frame_effort(const Problem& problem, double stretch, double most_s);

/// Returns the cheapest direct setting, in double, with that error. `by_lines` says that the problem is a
/// net, for which a tolerance of 1e-6 is tried too.
std::optional<Trial> direct_effort(const Problem& problem, double error, double most_s, bool by_lines);

}  // namespace plumb::bench
