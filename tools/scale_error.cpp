#include "scale_error.hpp"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <limits>

#include "frontier/contest.hpp"
#include "scenes/numbers.hpp"
#include "scenes/run.hpp"

namespace plumb::tools {
namespace {

using Clock = std::chrono::steady_clock;

/// Settings that were this much slower in a single run are not timed again.
constexpr double nearly = 1.3;
constexpr int most_repetitions = 10;
/// Beyond, rods are torn.
constexpr double most_stretch = 1;

double seconds_since(Clock::time_point start) {
  return std::chrono::duration<double>(Clock::now() - start).count();
}

/// What a run throws that takes too long.
struct TooLong {};

struct Tried {
  frontier::Path path;
  double ms = 0;
  double error = 0;
};

/// One run, or none if it broke. Throws TooLong.
std::optional<Tried> run(const frontier::Problem& problem, const frontier::Path& path, double most_s) {
  const auto start = Clock::now();
  scenes::RunObserver observer;
  observer.progress = [&](std::uint64_t, std::uint64_t) {
    if (seconds_since(start) > most_s) throw TooLong{};
  };
  const scenes::RunPlan plan{
      .settings = path.settings, .duration = problem.duration, .dt = 1.0 / path.frames};
  const scenes::RunResult result = scenes::run_scene(problem.scene, plan, problem.truth, observer);
  if (!result.sound() || result.total.unsolved > 0 || !(result.stretch.max <= most_stretch)) return {};
  return Tried{.path = path,
               .ms = 1e3 * result.wall_s / problem.duration,
               .error = result.position_error.back().relative};
}

std::vector<std::string> families_of(Method method) {
  if (method == Method::relax) return {"relax", "over-relaxed"};
  if (method == Method::springs) return {"springs", "implicit-springs"};
  return {std::string(to_string(method))};
}

std::optional<Cheapest> find_cheapest(const frontier::Problem& problem, Method method, double target,
                                      double path_s) {
  std::vector<Tried> found;
  double best_ms = std::numeric_limits<double>::infinity();
  for (const std::string& family : families_of(method))
    for (frontier::Path path : frontier::paths_of(family, problem)) {
      const auto start = Clock::now();
      do {
        // Measuring the frames takes time as well, hence some room.
        const double most_s = std::min(path_s, 1e-3 + 4e-3 * best_ms);
        std::optional<Tried> tried;
        try {
          tried = run(problem, path, most_s);
        } catch (const TooLong&) {
          break;
        }
        if (tried && tried->ms > nearly * best_ms) break;
        if (!tried || !(tried->error <= target)) continue;
        best_ms = std::min(best_ms, tried->ms);
        found.push_back(*tried);
        break;
      } while (seconds_since(start) < path_s && path.refine(path.settings));
    }
  if (found.empty()) return {};
  // In turns, so that what slows the machine down for a while favours none.
  std::erase_if(found, [&](const Tried& tried) { return tried.ms > nearly * best_ms; });
  const auto start = Clock::now();
  for (int round = 0; round < most_repetitions && seconds_since(start) < path_s; ++round)
    for (Tried& tried : found)
      if (const auto again = run(problem, tried.path, std::numeric_limits<double>::infinity()))
        tried.ms = std::min(tried.ms, again->ms);
  const auto best = std::min_element(found.begin(), found.end(),
                                     [](const Tried& a, const Tried& b) { return a.ms < b.ms; });
  return Cheapest{.setting = frontier::name_of(best->path.settings, best->path.frames),
                  .ms = best->ms,
                  .error = best->error};
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
