#include "scale/equal_error.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "frontier/contest.hpp"
#include "scenes/basics/clock.hpp"
#include "scenes/basics/numbers.hpp"

namespace plumb::tools {
namespace {

using scenes::Clock;
using scenes::seconds_since;

/// Settings that took longer in a single run, by this factor, are not timed again.
constexpr double nearly = 1.3;
constexpr int most_repetitions = 10;

/// These settings met the target, and the path runs them again.
struct Tried {
  frontier::Path path;
  frontier::Point point;
};

std::optional<Cheapest> find_cheapest(const frontier::Problem& problem, Method method, double target,
                                      double path_s) {
  std::vector<Tried> found;
  double best_ms = std::numeric_limits<double>::infinity();
  for (const std::string& family : frontier::families_of(method))
    for (frontier::Path path : frontier::paths_of(family, problem)) {
      const auto start = Clock::now();
      do {
        // Measuring the frames takes time as well, so the limit leaves room for it.
        const double most_s = std::min(path_s, 1e-3 + 4e-3 * best_ms);
        std::optional<frontier::Point> point;
        try {
          point = frontier::run(problem, path, most_s);
        } catch (const frontier::TooLong&) {
          break;
        }
        if (point && point->ms > nearly * best_ms) break;
        if (!point || !(point->position_error <= target)) continue;
        best_ms = std::min(best_ms, point->ms);
        found.push_back({path, *point});
        break;
      } while (seconds_since(start) < path_s && path.refine(path.settings));
    }
  if (found.empty()) return {};
  // All are timed in turns, so that what slows the machine down for a while favours none.
  std::erase_if(found, [&](const Tried& tried) { return tried.point.ms > nearly * best_ms; });
  const auto start = Clock::now();
  for (int round = 0; round < most_repetitions && seconds_since(start) < path_s; ++round)
    for (Tried& tried : found)
      if (const auto again = frontier::run(problem, tried.path, std::numeric_limits<double>::infinity()))
        tried.point.ms = std::min(tried.point.ms, again->ms);
  const auto best = std::min_element(found.begin(), found.end(),
                                     [](const Tried& a, const Tried& b) { return a.point.ms < b.point.ms; });
  return Cheapest{.setting = best->point.setting, .ms = best->point.ms, .error = best->point.position_error};
}

}  // namespace

std::string chain_spec(ChainFamily family, std::uint32_t links) {
  const std::string spec = "chain:links=" + std::to_string(links);
  if (family == ChainFamily::equal_links) return spec;
  return spec + ",length=" + scenes::short_number(1.0 / links, 17) +
         ",mass=" + scenes::short_number(1.0 / links, 17) +
         ",end_mass=" + scenes::short_number(1.0 / links, 17);
}

std::vector<EqualErrorCell> measure_at_equal_error(ChainFamily family, std::uint32_t links,
                                                   const std::vector<Method>& methods, double target,
                                                   double path_s) {
  frontier::Problem problem{.name = std::to_string(links), .spec = chain_spec(family, links)};
  frontier::prepare(problem, path_s);
  std::vector<Vec3> first;
  for (const Particle& particle : problem.scene.particles) first.push_back(particle.position);
  const double moved = rms_distance(problem.truth.back().positions, first) / bounding_diagonal(problem.scene);
  std::vector<EqualErrorCell> cells;
  for (const Method method : methods)
    cells.push_back({.family = family,
                     .links = links,
                     .method = method,
                     .moved = moved,
                     .cheapest = find_cheapest(problem, method, target, path_s)});
  return cells;
}

std::vector<Timing> timings_of(const std::vector<EqualErrorCell>& cells, ChainFamily family, Method method) {
  std::vector<Timing> out;
  for (const EqualErrorCell& cell : cells)
    if (cell.family == family && cell.method == method && cell.cheapest)
      out.emplace_back(cell.links, 1e-3 * cell.cheapest->ms);
  return out;
}

}  // namespace plumb::tools
