#include "direct/search.hpp"

#include <algorithm>
#include <array>
#include <bit>
#include <chrono>
#include <cmath>
#include <limits>
#include <utility>

#include "plumb/measures.hpp"
#include "plumb/world.hpp"

namespace plumb::bench {
namespace {

constexpr std::array gradients{Gradient::new_, Gradient::old, Gradient::mid};
constexpr std::array omegas{1.0, 1.5, 1.8, 1.9, 1.95};
constexpr std::array<std::uint32_t, 3> frame_rates{20, 30, 60};
constexpr std::uint32_t most_substeps = 1u << 16;
constexpr double never = std::numeric_limits<double>::infinity();
/// Float is not tried below this error, since its rounding takes too large a part of it.
constexpr double float_error = 1e-4;

/// Says where a sequence of settings leads and how far.
struct Route {
  const Problem& problem;
  const std::vector<Target>& targets;
  double most_s = 0;       ///< seconds of wall-clock time for a run
  double most_ms = never;  ///< ms per simulated second
};

/// Follows a sequence of ever finer settings, as long as the hardest target is not met and runs stay short.
/// It goes two settings further, because substeps that are too long are cut, and shorter ones can be cheaper.
template <class Next>
void follow(const Route& route, Setting setting, std::vector<Trial>& trials, Next&& refine) {
  constexpr int most_that_meet = 3;
  for (int that_meet = 0;;) {
    const Trial trial = run_trial(route.problem, setting, never);
    trials.push_back(trial);
    that_meet += std::all_of(route.targets.begin(), route.targets.end(),
                             [&](const Target& t) { return t.is_met(trial); });
    if (that_meet == most_that_meet || trial.ms > route.most_ms ||
        2e-3 * trial.ms * route.problem.duration > route.most_s || !refine(setting.settings))
      return;
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

/// Takes the cheapest few trials that meet the target.
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

/// Returns whether relaxation could not meet the target with as many substeps even if it converged. Gradients
/// old and mid would converge to what direct finds.
bool is_hopeless(const std::vector<Trial>& direct, Gradient gradient, std::uint32_t substeps,
                 const Target& target) {
  return std::any_of(direct.begin(), direct.end(), [&](const Trial& trial) {
    return trial.setting.frames == 60 && !trial.setting.settings.accuracy &&
           gradient_of(trial.setting.settings) == gradient && trial.setting.settings.substeps == substeps &&
           trial.error > 2 * target.error;
  });
}

/// Returns the cheapest relaxation that takes no longer than `cap_ms`, or nothing.
std::optional<Trial> search_relaxed(const Problem& problem, const Target& target, double cap_ms,
                                    const std::vector<Trial>& direct) {
  std::optional<Trial> best;
  const Precision precision = target.error > float_error ? Precision::single : Precision::double_;
  const double rate_s = [&] {  // seconds per sweep and substep
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

namespace {

/// Holds all runs that are not of relaxation.
struct Runs {
  std::vector<Trial> direct, with_accuracy, with_substeps;
};

Runs run_all(const Route& route) {
  Runs runs;
  for (const Precision precision : precisions_for(route.targets)) {
    for (const std::uint32_t frames : frame_rates) {
      for (const Gradient gradient : {Gradient::old, Gradient::mid}) {
        Setting setting{.settings = {.method = Method::direct,
                                     .precision = precision,
                                     .gradient = gradient,
                                     .threads = 1},
                        .frames = frames};
        follow(route, setting, runs.direct, double_substeps);
        setting.settings.accuracy = 0.5;
        follow(route, setting, runs.direct, halve_accuracy);
      }
      Setting setting{.settings = {.method = Method::automatic, .precision = precision, .threads = 1},
                      .frames = frames};
      follow(route, setting, runs.with_substeps, double_substeps);
      setting.settings.accuracy = 0.5;
      follow(route, setting, runs.with_accuracy, halve_accuracy);
    }
  }
  return runs;
}

/// Returns the cheapest runs of each kind that meet the target, timed again beside each other.
Answer answer_of(const Problem& problem, const Target& target, const Runs& runs, const SearchLimits& limits) {
  Answer answer{.target = target};
  std::vector<Trial> candidates;
  take_cheapest(runs.direct, target, 4, candidates);
  if (limits.relax && !candidates.empty()) {
    const auto found = search_relaxed(problem, target, relax_cap * candidates.front().ms, runs.direct);
    if (found) candidates.push_back(*found);
  }
  std::vector<Trial> mid;
  std::copy_if(runs.direct.begin(), runs.direct.end(), std::back_inserter(mid),
               [](const Trial& trial) { return gradient_of(trial.setting.settings) == Gradient::mid; });
  const std::size_t fixed_end = candidates.size();
  take_cheapest(mid, target, 3, candidates);
  const std::size_t mid_end = candidates.size();
  take_cheapest(runs.with_accuracy, target, 3, candidates);
  const std::size_t accuracy_end = candidates.size();
  take_cheapest(runs.with_substeps, target, 3, candidates);
  time_again(problem, candidates, limits.retime_s);
  const auto improve = [](std::optional<Trial>& best, const Trial& trial) {
    if (!best || trial.ms < best->ms) best = trial;
  };
  for (std::size_t i = 0; i < candidates.size(); ++i) {
    const Trial& trial = candidates[i];
    if (i >= accuracy_end) {
      improve(answer.automatic_substeps, trial);
    } else if (i >= mid_end) {
      improve(answer.automatic, trial);
    } else if (trial.setting.settings.method == Method::relax) {
      improve(answer.relaxed, trial);
    } else {
      improve(answer.fixed, trial);
      answer.others.push_back(trial);
      if (i >= fixed_end) improve(answer.mid, trial);
    }
  }
  return answer;
}

}  // namespace

std::vector<Answer> search(const Problem& problem, const std::vector<Target>& targets,
                           const SearchLimits& limits) {
  const Runs runs = run_all({.problem = problem, .targets = targets, .most_s = limits.trial_s});
  std::vector<Answer> answers;
  for (const Target& target : targets) answers.push_back(answer_of(problem, target, runs, limits));
  return answers;
}

namespace {

/// The work of a run is extrapolated by this factor at most. Beyond it a target counts as out of reach.
constexpr double farthest = 1e5;

/// Holds a family of ever more expensive relaxations.
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
  /// Refines until a run takes `most_s` (s) or comes within `error`.
  void go_on(const Problem& problem, double error, double most_s) {
    while (trials.empty() ||
           (!(trials.back().error <= error) && 2e-3 * trials.back().ms * problem.duration <= most_s))
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
    // A slope steeper than second order does not last. One that is not positive leads nowhere.
    effort.slope = std::min(effort.slope, 2.0);
    const double factor = effort.slope > 0 ? std::pow(effort.last.error / error, 1 / effort.slope) : never;
    effort.ms = factor > farthest ? never : effort.ms * factor;
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
  // What seems out of reach is judged by what it has come to.
  const auto is_better = [&](const Path& a, const Path& b) {
    const double ms_a = a.effort(error).ms, ms_b = b.effort(error).ms;
    return ms_a != ms_b ? ms_a < ms_b : a.trials.back().error < b.trials.back().error;
  };
  std::sort(paths.begin(), paths.end(), is_better);
  paths.resize(std::min<std::size_t>(paths.size(), 4));
  for (Path& path : paths) path.go_on(problem, error, most_s);
  return std::min_element(paths.begin(), paths.end(), is_better)->effort(error);
}

std::optional<Trial> direct_effort(const Problem& problem, double error, double most_s, bool by_lines) {
  const Target target{.name = "", .stretch = never, .error = error};
  std::vector<Trial> trials, candidates;
  double least_ms = never;  // dearer settings need not be refined
  // A tolerance is for nets alone. Other islands are solved to rounding whatever it is.
  const std::pair<Gradient, StopRule> kinds[] = {
      {Gradient::old, {.tolerance = std::min(error, 1e-6)}}, {Gradient::old, {}}, {Gradient::mid, {}}};
  for (const std::uint32_t frames : frame_rates) {
    for (const auto& [gradient, stop] : kinds) {
      if (stop.tolerance && !by_lines) continue;
      const Setting setting{
          .settings = {.method = Method::direct, .gradient = gradient, .stop = stop, .threads = 1},
          .frames = frames};
      follow({problem, {target}, most_s, least_ms}, setting, trials, double_substeps);
      for (const Trial& trial : trials)
        if (target.is_met(trial)) least_ms = std::min(least_ms, trial.ms);
    }
  }
  take_cheapest(trials, target, 2, candidates);
  if (candidates.empty()) return {};
  time_again(problem, candidates, 0.3);
  return *std::min_element(candidates.begin(), candidates.end(),
                           [](const Trial& a, const Trial& b) { return a.ms < b.ms; });
}

namespace {

/// Steps one frame from where `scene` is. Returns its stretch as error, and ms.
Trial run_frame(const Scene& scene, const Setting& setting) {
  World world(scene, setting.settings);
  const auto start = std::chrono::steady_clock::now();
  world.step(1.0 / setting.frames);
  const std::chrono::duration<double> s = std::chrono::steady_clock::now() - start;
  std::vector<Vec3> positions(world.particle_count());
  world.copy_positions(positions);
  const double stretch = measure_stretch(scene, positions).max;
  return {.setting = setting, .error = stretch, .stretch = stretch, .ms = 1e3 * s.count()};
}

}  // namespace

FrameEffort frame_effort(const Problem& problem, double stretch, double most_s) {
  Scene scene = problem.scene;
  const Setting direct{.settings = {.method = Method::direct, .gradient = Gradient::mid, .threads = 1}};
  World world(scene, direct.settings);
  for (std::uint32_t i = 0; i < problem.duration * direct.frames; ++i) world.step(1.0 / direct.frames);
  for (std::uint32_t i = 0; i < scene.particles.size(); ++i) {
    scene.particles[i].position = world.position(i);
    scene.particles[i].velocity = world.velocity(i);
  }
  for (Rod& rod : scene.rods)
    if (rod.length == 0)
      rod.length = norm(problem.scene.particles[rod.b].position - problem.scene.particles[rod.a].position);
  FrameEffort out{.direct_ms = never};
  for (int i = 0; i < 10; ++i) {
    const Trial trial = run_frame(scene, direct);
    out.direct_ms = std::min(out.direct_ms, trial.ms);
    out.direct_stretch = trial.error;
  }
  for (Effort* effort : {&out.plain, &out.over}) {
    std::vector<Path> paths;
    for (const double omega : omegas)
      if ((omega != 1) == (effort == &out.over))
        paths.push_back({relaxed(Gradient::mid, omega, Precision::double_, 1, 64), true});
    // The most promising path goes on alone.
    for (const double until_s : {most_s / 8, most_s}) {
      for (Path& path : paths) {
        while (path.trials.empty() ||
               (path.trials.back().error > stretch && 2e-3 * path.trials.back().ms <= until_s)) {
          path.trials.push_back(run_frame(scene, path.next));
          path.next.settings.stop.sweeps *= 2;
        }
      }
      std::sort(paths.begin(), paths.end(),
                [&](const Path& a, const Path& b) { return a.effort(stretch).ms < b.effort(stretch).ms; });
      paths.resize(1);
    }
    *effort = paths.front().effort(stretch);
  }
  return out;
}

}  // namespace plumb::bench
