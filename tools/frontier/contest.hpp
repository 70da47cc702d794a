#pragma once

#include <cstdint>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "frontier/problem.hpp"
#include "scenes/runs/run.hpp"

namespace plumb::frontier {

/// A path leads to ever finer settings of one method.
struct Path {
  std::string family;  ///< Family: methods that are drawn as one.
  Settings settings{};
  std::uint32_t frames = 60;  ///< Frames per simulated second.
  /// Makes the settings finer. Returns false if they cannot be.
  std::function<bool(Settings&)> refine{};
};

/// A point is one way to move a scene, and what came of it.
struct Point {
  std::string family{}, setting{};
  std::uint32_t frames = 60;
  Settings settings{};
  double ms = 0;         ///< Time of stepping per simulated second in ms, the least of the repetitions.
  double median_ms = 0;  ///< The median of the repetitions, in ms.
  std::uint32_t repetitions = 1;
  double position_error = 0;  ///< RMS over particles at the end, relative to the scene's diagonal.
  double stretch = 0;         ///< Largest strain over all rods and ends of frames.
  double energy_drift = 0;    ///< Largest drift, relative to the scene's energy range; 0 where rods do work.
  bool on_front = false;      ///< Whether nothing measured is both faster and nearer to the truth.
  std::string picked{};       ///< What method auto picked.
};

/// The families into which the ways to set a method are sorted. Most methods are one family of their own
/// name.
std::vector<std::string> families_of(Method method);

/// The families of all methods in the kernel's table, in the order in which they are drawn.
std::vector<std::string> all_families();

/// Returns every path of a family through a problem.
std::vector<Path> paths_of(const std::string& family, const Problem& problem);

/// Says a setting in few words: method, options, frames a second x substeps (or accuracy) x sweeps.
std::string name_of(const Settings& settings, std::uint32_t frames);
/// Says what method auto took.
std::string picked_by(const WorldInfo& info);

/// A run throws this if it takes too long.
struct TooLong {};

/// Runs a path's present settings once. Returns nothing if the run did not stay finite, left substeps
/// unsolved, or stretched a rod to twice its length. Throws TooLong after `most_s` of wall-clock time.
std::optional<Point> run(const Problem& problem, const Path& path, double most_s);

struct Limits {
  /// Wall-clock time for a path in s, multiplied by Problem::patience. Its last run may take as much again.
  double path_s = 0.1;
  double contest_s = 6;  ///< Wall-clock time for the repetitions, in s.
};

/// Runs every path, from coarse to fine, and marks the front. It times again, in turns, what is on the front
/// or nearly, and what each family needs for its own front. Settings that do not stay finite, or whose rods
/// stretch to twice their length, are left out.
std::vector<Point> compete(const Problem& problem, const std::vector<std::string>& families,
                           const Limits& limits);

/// Returns which points, given by time and error, no other dominates. Errors below `floor`, what the truth is
/// known to, count as equal.
std::vector<bool> find_front(const std::vector<std::pair<double, double>>& time_and_error, double floor);

/// Sets on_front of every point.
void mark_front(std::vector<Point>& points, double floor);

}  // namespace plumb::frontier
