#include "direct/search.hpp"

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <limits>

namespace plumb::bench {
namespace {

constexpr std::array gradients{Gradient::new_, Gradient::old, Gradient::mid};
constexpr std::array omegas{1.0, 1.5, 1.8, 1.9, 1.95};
constexpr std::array<std::uint32_t, 3> frame_rates{60, 30, 20};
constexpr std::uint32_t most_substeps = 1u << 16;
constexpr double never = std::numeric_limits<double>::infinity();
/// Below this error float is not tried.
constexpr double float_error = 1e-4;

/// Follows a sequence of ever finer settings, as long as the hardest target is not met and runs stay short.
template <class Next>
void follow(const Problem& problem, const std::vector<Target>& targets, double most_s, Setting setting,
            std::vector<Trial>& trials, Next&& refine) {
  for (;;) {
    const Trial trial = run_trial(problem, setting, never);
    trials.push_back(trial);
    const bool all_met =
        std::all_of(targets.begin(), targets.end(), [&](const Target& t) { return t.is_met(trial); });
    if (all_met || 2e-3 * trial.ms * problem.duration > most_s || !refine(setting.settings)) return;
  }
}

bool double_substeps(Settings& settings) {
  settings.substeps *= 2;
  return settings.substeps <= most_substeps;
}
bool halve_accuracy(Settings& settings) {
  settings.accuracy = *settings.accuracy / 2;
  return *settings.accuracy > 1e-9;
}

std::vector<Precision> precisions_for(const std::vector<Target>& targets) {
  if (targets.front().error > float_error) return {Precision::single, Precision::double_};
  return {Precision::double_};
}

/// The cheapest few that meet the target.
void take_cheapest(const std::vector<Trial>& trials, const Target& target, std::size_t count,
                   std::vector<Trial>& out) {
  std::vector<Trial> met;
  std::copy_if(trials.begin(), trials.end(), std::back_inserter(met),
               [&](const Trial& trial) { return target.is_met(trial); });
  std::sort(met.begin(), met.end(), [](const Trial& a, const Trial& b) { return a.ms < b.ms; });
  met.resize(std::min(met.size(), count));
  out.insert(out.end(), met.begin(), met.end());
}

Setting relaxed(Gradient gradient, double omega, Precision precision, std::uint32_t substeps,
                std::uint32_t sweeps) {
  return {.settings = {.method = Method::relax,
                       .precision = precision,
                       .gradient = gradient,
                       .omega = omega,
                       .substeps = substeps,
                       .stop = {.sweeps = sweeps},
                       .threads = 1}};
}

/// Whether relaxation with as many substeps could meet the target if it converged: gradients old and mid do
/// to what direct finds.
bool is_hopeless(const std::vector<Trial>& direct, Gradient gradient, std::uint32_t substeps,
                 const Target& target) {
  return std::any_of(direct.begin(), direct.end(), [&](const Trial& trial) {
    return trial.setting.frames == 60 && !trial.setting.settings.accuracy &&
           gradient_of(trial.setting.settings) == gradient && trial.setting.settings.substeps == substeps &&
           trial.error > 2 * target.error;
  });
}

/// The cheapest relaxation that takes no longer than `cap_ms`, or none.
std::optional<Trial> search_relaxed(const Problem& problem, const Target& target, double cap_ms,
                                    const std::vector<Trial>& direct) {
  std::optional<Trial> best;
  const Precision precision = target.error > float_error ? Precision::single : Precision::double_;
  const double rate_s = [&] {  // per sweep and substep
    const Setting probe = relaxed(Gradient::new_, 1, precision, 2, 16);
    return run_trial(problem, probe, never).ms / (60 * probe.updates());
  }();
  double work_cap = std::max(1.0, cap_ms / (60 * rate_s));
  for (const double omega : omegas) {
    for (const Gradient gradient : gradients) {
      for (std::uint32_t substeps = 1; substeps <= work_cap; substeps *= 2) {
        if (is_hopeless(direct, gradient, substeps, target)) continue;
        auto sweeps = std::bit_floor(static_cast<std::uint32_t>(work_cap / substeps));
        for (; sweeps > 0; sweeps /= 2) {
          const Trial trial = run_trial(problem, relaxed(gradient, omega, precision, substeps, sweeps),
                                        target.stretch, 4e-3 * cap_ms * problem.duration);
          if (!target.is_met(trial)) break;
          if (!best || trial.ms < best->ms) best = trial;
          work_cap = std::min(work_cap, double{1} * substeps * sweeps);
        }
      }
    }
  }
  return best;
}

}  // namespace

const Trial* Answer::best() const {
  if (fixed && relaxed) return fixed->ms <= relaxed->ms ? &*fixed : &*relaxed;
  return fixed ? &*fixed : relaxed ? &*relaxed : nullptr;
}

std::vector<Answer> search(const Problem& problem, const std::vector<Target>& targets,
                           const SearchLimits& limits) {
  std::vector<Trial> direct, with_accuracy, with_substeps;
  for (const Precision precision : precisions_for(targets)) {
    for (const std::uint32_t frames : frame_rates) {
      for (const Gradient gradient : {Gradient::old, Gradient::mid}) {
        Setting setting{.settings = {.method = Method::direct,
                                     .precision = precision,
                                     .gradient = gradient,
                                     .threads = 1},
                        .frames = frames};
        follow(problem, targets, limits.trial_s, setting, direct, double_substeps);
        setting.settings.accuracy = 0.5;
        follow(problem, targets, limits.trial_s, setting, direct, halve_accuracy);
      }
      Setting setting{.settings = {.method = Method::automatic, .precision = precision, .threads = 1},
                      .frames = frames};
      follow(problem, targets, limits.trial_s, setting, with_substeps, double_substeps);
      setting.settings.accuracy = 0.5;
      follow(problem, targets, limits.trial_s, setting, with_accuracy, halve_accuracy);
    }
  }
  std::vector<Answer> answers;
  for (const Target& target : targets) {
    Answer answer{.target = target};
    std::vector<Trial> candidates;
    take_cheapest(direct, target, 4, candidates);
    if (limits.relax && !candidates.empty()) {
      const auto found = search_relaxed(problem, target, relax_cap * candidates.front().ms, direct);
      if (found) candidates.push_back(*found);
    }
    const std::size_t fixed_end = candidates.size();
    take_cheapest(with_accuracy, target, 3, candidates);
    const std::size_t accuracy_end = candidates.size();
    take_cheapest(with_substeps, target, 3, candidates);
    time_again(problem, candidates, limits.retime_s);
    for (const Gradient gradient : {Gradient::old, Gradient::mid}) {
      std::vector<Trial> same;
      std::copy_if(direct.begin(), direct.end(), std::back_inserter(same),
                   [&](const Trial& trial) { return gradient_of(trial.setting.settings) == gradient; });
      take_cheapest(same, target, 2, answer.others);
    }
    for (std::size_t i = 0; i < candidates.size(); ++i) {
      const Trial& trial = candidates[i];
      auto& best = i >= accuracy_end                                ? answer.automatic_substeps
                   : i >= fixed_end                                 ? answer.automatic
                   : trial.setting.settings.method == Method::relax ? answer.relaxed
                                                                    : answer.fixed;
      if (!best || trial.ms < best->ms) best = trial;
    }
    answers.push_back(answer);
  }
  return answers;
}

namespace {

/// A family of ever more expensive relaxations.
struct Path {
  Setting next;
  bool by_sweeps;
  std::vector<Trial> trials{};

  bool is_broken() const { return !trials.empty() && !std::isfinite(trials.back().error); }
  void go_on(const Problem& problem) {
    trials.push_back(run_trial(problem, next, never));
    if (by_sweeps)
      next.settings.stop.sweeps *= 2;
    else
      next.settings.substeps *= 2;
  }
  /// Until a run takes `most_s` or comes within `error`.
  void go_on(const Problem& problem, double error, double most_s) {
    while (!is_broken() && (trials.empty() || (trials.back().error > error &&
                                               2e-3 * trials.back().ms * problem.duration <= most_s)))
      go_on(problem);
  }
  Effort effort(double error) const {
    Effort effort{.last = trials.back(), .ms = trials.back().ms};
    if (is_broken()) effort.ms = never;
    if (is_broken() || effort.last.error <= error) return effort;
    effort.extrapolated = true;
    if (trials.size() >= 3) {
      const Trial& before = trials[trials.size() - 3];
      effort.slope = std::log2(before.error / effort.last.error) / 2;
    }
    // Steeper than second order does not last; flatter than this leads nowhere.
    effort.slope = std::min(effort.slope, 2.0);
    effort.ms =
        effort.slope < 0.05 ? never : effort.ms * std::pow(effort.last.error / error, 1 / effort.slope);
    return effort;
  }
};

}  // namespace

Effort relax_effort(const Problem& problem, double error, bool over_relaxed, double first_s, double most_s) {
  std::vector<Path> paths;
  for (const double omega : omegas) {
    if ((omega != 1) != over_relaxed) continue;
    for (const Gradient gradient : gradients)
      for (const std::uint32_t sweeps : {1u, 8u, 64u})
        paths.push_back({relaxed(gradient, omega, Precision::double_, 1, sweeps), false});
    for (const std::uint32_t substeps : {1u, 8u, 64u})
      paths.push_back({relaxed(Gradient::mid, omega, Precision::double_, substeps, 1), true});
  }
  for (Path& path : paths) path.go_on(problem, error, first_s);
  std::sort(paths.begin(), paths.end(),
            [&](const Path& a, const Path& b) { return a.effort(error).ms < b.effort(error).ms; });
  Effort best{.ms = never};
  for (std::size_t i = 0; i < std::min<std::size_t>(paths.size(), 3); ++i) {
    if (!std::isfinite(paths[i].effort(error).ms)) break;
    paths[i].go_on(problem, error, most_s);
    const Effort effort = paths[i].effort(error);
    if (effort.ms < best.ms) best = effort;
  }
  return best;
}

std::optional<Trial> direct_effort(const Problem& problem, double error, double most_s) {
  const Target target{.name = "", .stretch = never, .error = error};
  std::vector<Trial> trials, candidates;
  for (const Gradient gradient : {Gradient::old, Gradient::mid}) {
    const Setting setting{.settings = {.method = Method::direct, .gradient = gradient, .threads = 1}};
    follow(problem, {target}, most_s, setting, trials, double_substeps);
  }
  take_cheapest(trials, target, 2, candidates);
  if (candidates.empty()) return {};
  time_again(problem, candidates, 0.3);
  return *std::min_element(candidates.begin(), candidates.end(),
                           [](const Trial& a, const Trial& b) { return a.ms < b.ms; });
}

}  // namespace plumb::bench
