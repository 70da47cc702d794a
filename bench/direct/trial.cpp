#include "direct/trial.hpp"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <limits>

#include "plumb/world.hpp"
#include "scenes/basics/numbers.hpp"

namespace plumb::bench {
namespace {

using Clock = std::chrono::steady_clock;
using scenes::short_number;

double seconds_since(Clock::time_point start) {
  return std::chrono::duration<double>(Clock::now() - start).count();
}

std::uint32_t frame_count(const Problem& problem, const Setting& setting) {
  return static_cast<std::uint32_t>(std::lround(problem.duration * setting.frames));
}

std::vector<Vec3> end_of(const Problem& problem, std::uint32_t substeps) {
  const Setting setting{
      .settings = {.method = Method::direct, .gradient = Gradient::old, .substeps = substeps, .threads = 1}};
  World world(problem.scene, setting.settings);
  for (std::uint32_t i = 0; i < frame_count(problem, setting); ++i) world.step(1.0 / setting.frames);
  std::vector<Vec3> positions(world.particle_count());
  world.copy_positions(positions);
  return positions;
}

}  // namespace

void find_truth(Problem& problem, double tolerance, double most_s, std::uint32_t substeps) {
  std::vector<Vec3> coarse, extrapolated;
  problem.truth_error = std::numeric_limits<double>::infinity();
  for (;; substeps *= 2) {
    const auto start = Clock::now();
    const std::vector<Vec3> fine = end_of(problem, substeps);
    const double s = seconds_since(start);
    if (!coarse.empty()) {
      std::vector<Vec3> better(fine.size());
      for (std::size_t i = 0; i < fine.size(); ++i) better[i] = fine[i] + (1.0 / 3) * (fine[i] - coarse[i]);
      if (!extrapolated.empty()) problem.truth_error = rms_distance(better, extrapolated) / problem.diagonal;
      extrapolated = better;
    }
    coarse = fine;
    if (std::isfinite(problem.truth_error) && (problem.truth_error <= tolerance || 2 * s > most_s)) break;
  }
  problem.truth = extrapolated;
}

double position_error(const Problem& problem, const std::vector<Vec3>& positions) {
  return rms_distance(positions, problem.truth) / problem.diagonal;
}

std::string Setting::name() const {
  const Gradient gradient = gradient_of(settings);
  std::string out(to_string(settings.method));
  if (settings.method != Method::automatic) out.append(1, ' ').append(to_string(gradient));
  if (settings.method == Method::relax && settings.omega != 1) out += " w" + short_number(settings.omega);
  out += settings.precision == Precision::single ? " float " : " double ";
  out += std::to_string(frames) + " x ";
  if (settings.accuracy) return out + "a" + short_number(*settings.accuracy, 2);
  out += std::to_string(settings.substeps);
  if (settings.method == Method::relax) return out + " x " + std::to_string(settings.stop.sweeps);
  return settings.stop.tolerance ? out + " to " + short_number(*settings.stop.tolerance) : out;
}

Trial run_trial(const Problem& problem, const Setting& setting, double most_stretch, double most_s) {
  Trial trial{.setting = setting};
  World world(problem.scene, setting.settings);
  std::vector<Vec3> positions(world.particle_count());
  double s = 0;
  for (std::uint32_t i = 0; i < frame_count(problem, setting); ++i) {
    const auto start = Clock::now();
    world.step(1.0 / setting.frames);
    s += seconds_since(start);
    world.copy_positions(positions);
    // The comparison is written so that a value that is not a number wins.
    const double stretch = measure_stretch(problem.scene, positions).max;
    if (!(stretch <= trial.stretch)) trial.stretch = stretch;
    if (trial.stretch <= most_stretch && s <= most_s) continue;
    trial.finished = false;
    trial.ms = 1e3 * s / (i + 1) * setting.frames;
    trial.error = trial.stretch = std::numeric_limits<double>::infinity();
    return trial;
  }
  trial.ms = 1e3 * s / problem.duration;
  trial.error = position_error(problem, positions);
  if (!std::isfinite(trial.error) || !std::isfinite(trial.stretch))
    trial.error = trial.stretch = std::numeric_limits<double>::infinity();
  return trial;
}

void time_again(const Problem& problem, std::vector<Trial>& trials, double budget_s) {
  double round_s = 1e-6;
  for (const Trial& trial : trials) round_s += 1e-3 * trial.ms * problem.duration;
  const int rounds = static_cast<int>(std::clamp(budget_s / round_s, round_s > 1 ? 2.0 : 3.0, 60.0));
  std::vector<double> least(trials.size(), std::numeric_limits<double>::infinity());
  for (int round = 0; round < rounds; ++round) {
    for (std::size_t k = 0; k < trials.size(); ++k) {
      const std::size_t i = (k + static_cast<std::size_t>(round)) % trials.size();
      const Setting& setting = trials[i].setting;
      World world(problem.scene, setting.settings);
      const auto start = Clock::now();
      for (std::uint32_t frame = 0; frame < frame_count(problem, setting); ++frame)
        world.step(1.0 / setting.frames);
      least[i] = std::min(least[i], 1e3 * seconds_since(start) / problem.duration);
    }
  }
  for (std::size_t i = 0; i < trials.size(); ++i) trials[i].ms = least[i];
}

}  // namespace plumb::bench
