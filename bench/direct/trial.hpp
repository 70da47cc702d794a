#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "plumb/measures.hpp"
#include "plumb/scene.hpp"
#include "plumb/settings.hpp"

namespace plumb::bench {

/// Holds a scene, how long it moves, and where it truly is then.
struct Problem {
  std::string name;
  Scene scene;
  double duration = 1;        ///< s
  std::vector<Vec3> truth{};  ///< positions at the end, m
  double truth_error = 0;     ///< error of the truth, relative to the diagonal
  double diagonal = 1;        ///< diagonal of the scene's first bounding box, m
};

/// Finds the truth by method direct with gradient old. Every run has twice the substeps of the one before,
/// and Richardson's method extrapolates. It ends once two extrapolations lie within `tolerance` or a run
/// takes longer than `most_s` (s), after three runs at least. The first run has `substeps` in a frame.
void find_truth(Problem& problem, double tolerance, double most_s, std::uint32_t substeps = 8);

/// Returns the RMS distance of positions to the truth, relative to the diagonal.
double position_error(const Problem& problem, const std::vector<Vec3>& positions);

/// Names one way of stepping a scene, on one thread.
struct Setting {
  Settings settings{};
  std::uint32_t frames = 60;  ///< calls of World::step per second

  std::string name() const;
  double updates() const { return double{1} * settings.substeps * settings.stop.sweeps; }
};

struct Trial {
  Setting setting{};
  double error = 0;    ///< error at the end, see position_error()
  double stretch = 0;  ///< largest stretch at any frame's end
  double ms = 0;       ///< ms per simulated second, in World::step alone
  bool finished = true;
};

struct Target {
  std::string name;
  double stretch, error;
  bool is_met(const Trial& trial) const { return trial.stretch <= stretch && trial.error <= error; }
};

/// Runs a setting once. Gives up as soon as a frame ends with a stretch above `most_stretch`, or time has
/// passed.
Trial run_trial(const Problem& problem, const Setting& setting, double most_stretch, double most_s = 1e9);

/// Replaces ms of every trial by the least of several runs, made by turns, within about `budget_s` (s).
void time_again(const Problem& problem, std::vector<Trial>& trials, double budget_s);

}  // namespace plumb::bench
