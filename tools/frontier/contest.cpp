#include "frontier/contest.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>

#include "plumb/error.hpp"
#include "plumb/world.hpp"
#include "scenes/basics/clock.hpp"

namespace plumb::frontier {
namespace {

using scenes::Clock;
using scenes::seconds_since;

/// Beyond this strain, rods count as torn.
constexpr double most_stretch = 1;
/// A setting is timed again if it would be on a front were it this many times as fast.
constexpr double nearly = 1.5;
constexpr std::uint32_t most_repetitions = 40;
/// A family without a point is given up once a path took this many times as long as it may. A step cannot be
/// cut short, and the family's other paths solve the same.
constexpr double hopeless = 10;

void follow(const Problem& problem, Path path, double most_s, std::vector<Point>& points) {
  const auto start = Clock::now();
  double last = 0;
  do {
    try {
      const double before = seconds_since(start);
      // Twice as fine takes about twice as long.
      if (2 * last > most_s - before && before > 0.5 * most_s) return;
      const auto point = run(problem, path, 2 * most_s);
      last = seconds_since(start) - before;
      if (point) points.push_back(*point);
      if (point && point->position_error <= 2 * problem.truth_error) return;
    } catch (const TooLong&) {
      return;
    }
  } while (seconds_since(start) < most_s && path.refine(path.settings));
}

/// Times settings in turns, so that what slows the machine down for a while favours none. The first runs
/// count too.
void time_again(const Problem& problem, std::vector<Point>& points, const std::vector<std::size_t>& chosen,
                double most_s) {
  std::vector<std::vector<double>> times;
  for (const std::size_t i : chosen) times.push_back({points[i].ms});
  const auto start = Clock::now();
  for (std::uint32_t round = 0; round < most_repetitions && seconds_since(start) < most_s; ++round) {
    for (std::size_t k = 0; k < chosen.size() && seconds_since(start) < 2 * most_s; ++k) {
      // The order changes every round, so that what stays out of the last one is not always the same.
      const std::size_t i = (k + 7 * round) % chosen.size();
      const Point& point = points[chosen[i]];
      World world(problem.scene, point.settings);
      const auto frames = static_cast<std::uint64_t>(std::lround(problem.duration * point.frames));
      const auto begin = Clock::now();
      for (std::uint64_t frame = 0; frame < frames; ++frame) {
        const double end = static_cast<double>(frame + 1) / point.frames;
        scenes::set_lengths(world, problem.scene, problem.rates, end);
        world.step(1.0 / point.frames);
      }
      times[i].push_back(1e3 * seconds_since(begin) / problem.duration);
    }
  }
  for (std::size_t i = 0; i < chosen.size(); ++i) {
    std::sort(times[i].begin(), times[i].end());
    Point& point = points[chosen[i]];
    point.ms = times[i].front();
    point.median_ms = times[i][times[i].size() / 2];
    point.repetitions = static_cast<std::uint32_t>(times[i].size());
  }
}

/// Returns points that may be on their family's front, allowing for noise in their times.
std::vector<std::size_t> choose(const std::vector<Point>& points, double floor) {
  std::vector<std::size_t> out;
  for (std::size_t i = 0; i < points.size(); ++i) {
    const bool beaten = std::any_of(points.begin(), points.end(), [&](const Point& other) {
      return other.family == points[i].family && other.ms * nearly < points[i].ms &&
             std::max(other.position_error, floor) <= std::max(points[i].position_error, floor);
    });
    if (!beaten) out.push_back(i);
  }
  return out;
}

}  // namespace

std::optional<Point> run(const Problem& problem, const Path& path, double most_s) {
  const auto start = Clock::now();
  scenes::RunObserver observer;
  observer.progress = [&](std::uint64_t, std::uint64_t) {
    if (seconds_since(start) > most_s) throw TooLong{};
  };
  const scenes::RunPlan plan{.settings = path.settings,
                             .duration = problem.duration,
                             .dt = 1.0 / path.frames,
                             .rates = problem.rates};
  const scenes::RunResult result = scenes::run_scene(problem.scene, plan, problem.truth, observer);
  if (!result.sound() || result.total.unsolved > 0 || !(result.stretch.max <= most_stretch)) return {};
  Point point{.family = path.family,
              .setting = name_of(path.settings, path.frames),
              .frames = path.frames,
              .settings = path.settings};
  point.ms = point.median_ms = 1e3 * result.wall_s / problem.duration;
  point.position_error = result.position_error.back().relative;
  point.stretch = result.stretch.max;
  if (problem.rates.empty() && result.energy.range > 0)  // else work is done
    point.energy_drift = result.energy.drift_max / result.energy.range;
  if (path.settings.method == Method::automatic) point.picked = picked_by(result.info);
  return point;
}

std::vector<bool> find_front(const std::vector<std::pair<double, double>>& points, double floor) {
  std::vector<std::size_t> order(points.size());
  for (std::size_t i = 0; i < order.size(); ++i) order[i] = i;
  const auto error = [&](std::size_t i) { return std::max(points[i].second, floor); };
  std::sort(order.begin(), order.end(), [&](std::size_t a, std::size_t b) {
    return std::pair(points[a].first, error(a)) < std::pair(points[b].first, error(b));
  });
  std::vector<bool> out(points.size(), false);
  double least = std::numeric_limits<double>::infinity();
  for (const std::size_t i : order) {
    out[i] = error(i) < least;
    least = std::min(least, error(i));
  }
  return out;
}

void mark_front(std::vector<Point>& points, double floor) {
  std::vector<std::pair<double, double>> list;
  for (const Point& point : points) list.emplace_back(point.ms, point.position_error);
  const std::vector<bool> front = find_front(list, floor);
  for (std::size_t i = 0; i < points.size(); ++i) points[i].on_front = front[i];
}

std::vector<Point> compete(const Problem& problem, const std::vector<std::string>& families,
                           const Limits& limits) {
  std::vector<Point> points;
  const double path_s = problem.patience * limits.path_s;
  for (const std::string& family : families) {
    const std::size_t before = points.size();
    for (const Path& path : paths_of(family, problem)) {
      const auto start = Clock::now();
      follow(problem, path, path_s, points);
      if (points.size() == before && seconds_since(start) > hopeless * path_s) break;
    }
  }
  time_again(problem, points, choose(points, problem.truth_error), limits.contest_s);
  mark_front(points, problem.truth_error);
  return points;
}

}  // namespace plumb::frontier
