#include "scale/measure.hpp"

#include <algorithm>
#include <cmath>
#include <memory>

#include "plumb/error.hpp"
#include "plumb/reference/springs.hpp"
#include "plumb/world.hpp"
#include "scenes/basics/clock.hpp"
#include "scenes/basics/numbers.hpp"
#include "scenes/generators/generators.hpp"

namespace plumb::tools {
namespace {

using scenes::Clock;
using scenes::seconds_since;

constexpr std::uint32_t most_substeps = 64;
/// Fewer frames say too little of the mean over a second.
constexpr int least_frames = 10;

/// This is what came of stepping a simulated second.
struct Second {
  double stepping_s = 0;
  int frames = 0;
  CellOutcome outcome = CellOutcome::measured;
};

/// Steps a second, or as much of it as `cap_s` of wall-clock time allows. It reads the clock after every
/// frame only where chains are so long that reading costs nothing.
Second step_second(World& world, double cap_s) {
  Second out;
  const auto start = Clock::now();
  const bool watched = world.particle_count() > 100;
  while (out.frames < scale_frames && out.outcome == CellOutcome::measured) {
    const StepReport report = world.step(scale_frame);
    ++out.frames;
    if (report.frozen_islands > 0 || report.unsolved > 0) out.outcome = CellOutcome::broke;
    if (watched && seconds_since(start) > cap_s) break;
  }
  out.stepping_s = seconds_since(start);
  if (out.outcome == CellOutcome::measured && out.frames < least_frames) out.outcome = CellOutcome::too_slow;
  return out;
}

/// Whether a chain gained more energy than falling through its whole length gives. A chain that starts at
/// rest gains none in truth, so such a state counts as broken.
bool is_lively(const Scene& scene, const World& world, const std::vector<Vec3>& positions) {
  std::vector<Vec3> velocities(positions.size());
  world.copy_velocities(velocities);
  const std::vector<Vec3> still(positions.size());
  std::vector<Vec3> first;
  for (const Particle& particle : scene.particles) first.push_back(particle.position);
  const double gain =
      measure_energy(scene, positions, velocities).total() - measure_energy(scene, first, still).total();
  return !(gain <= energy_range(scene));
}

}  // namespace

std::vector<Method> methods_of_table() {
  std::vector<Method> out;
  for (const MethodInfo& info : all_methods()) out.push_back(info.method);
  return out;
}

std::vector<ScaleSeries> all_series(const ScaleOptions& options) {
  std::vector<ScaleSeries> out;
  for (const Method method : options.methods) {
    if (method != Method::relax) {
      out.push_back({.method = method});
      continue;
    }
    for (const SweepOrder order : options.orders)
      for (const Precision precision : options.precisions)
        for (const bool all_threads : {false, true})
          out.push_back(
              {.method = method, .order = order, .precision = precision, .all_threads = all_threads});
  }
  return out;
}

std::string name_of(const ScaleSeries& series) {
  std::string name(to_string(series.method));
  if (series.method != Method::relax) return name;
  if (series.order == SweepOrder::jacobi) name += ", " + std::string(to_string(series.order));
  return name + ", " + std::string(to_string(series.precision)) + (series.all_threads ? ", threads" : "");
}

Settings settings_of(const ScaleSeries& series, const ScaleOptions& options) {
  Settings settings{.method = series.method, .precision = series.precision, .order = series.order};
  settings.threads = series.all_threads ? 0 : 1;
  if (series.method == Method::relax) settings.stop.sweeps = options.sweeps;
  if (series.method == Method::springs) {
    settings.integrator = Integrator::semi_implicit_euler;
    settings.springs.stiffness = 1;
    // The fastest vibration of a chain hardly depends on its length from some links on.
    const double unit = spring_stability(scenes::make_chain(40), settings).frequency;
    settings.springs.stiffness = std::pow(0.5 / scale_frame / unit, 2);
  }
  return settings;
}

std::string describe(const Settings& settings) {
  switch (settings.method) {
    case Method::relax:
      return std::to_string(settings.stop.sweeps) + " sweeps, " + std::string(to_string(settings.order)) +
             ", gradient " + std::string(to_string(gradient_of(settings)));
    case Method::direct:
      return "gradient " + std::string(to_string(gradient_of(settings)));
    case Method::springs:
      return std::string(to_string(settings.springs.model)) + ", " +
             std::string(to_string(integrator_of(settings))) + ", " +
             scenes::short_number(settings.springs.stiffness, 3) + " N/m, damped " +
             scenes::short_number(settings.springs.damping_ratio, 2);
    case Method::multipliers:
      return std::string(to_string(integrator_of(settings))) + ", " +
             std::string(to_string(settings.multipliers.stabilization));
    case Method::featherstone:
      return std::string(to_string(integrator_of(settings)));
    case Method::automatic:
      break;
  }
  return "as it picks";
}

ScaleCell measure_cell(const ScaleSeries& series, std::uint32_t links, const Settings& settings,
                       const ScaleOptions& options, double& first_s) {
  ScaleCell cell{
      .series = series, .links = links, .sweeps = settings.stop.sweeps, .substeps = settings.substeps};
  const auto start = Clock::now();
  const Scene scene = scenes::make_chain(links);
  std::vector<double> times;  // Times of a frame, in s.
  do {
    double stepping_s = 0;
    std::uint64_t frames = 0;
    do {
      std::unique_ptr<World> world;
      try {
        world = std::make_unique<World>(scene, settings);
      } catch (const InputError&) {
        cell.outcome = CellOutcome::refused;
        return cell;
      }
      cell.threads = world->info().parallel ? world->info().threads : 1;
      if (series.all_threads && cell.threads == 1) {
        cell.outcome = CellOutcome::alike;
        return cell;
      }
      const Second second = step_second(*world, options.cell_s);
      cell.outcome = second.outcome;
      if (frames == 0 && times.empty()) {
        first_s = second.stepping_s;
        cell.frames = second.frames;
        std::vector<Vec3> positions(world->particle_count());
        world->copy_positions(positions);
        cell.stretch = measure_stretch(scene, positions);
        cell.state_hash = world->state_hash();
        if (cell.measured() && is_lively(scene, *world, positions)) cell.outcome = CellOutcome::broke;
        if (!cell.measured()) return cell;
      }
      stepping_s += second.stepping_s;
      frames += static_cast<std::uint64_t>(second.frames);
    } while (stepping_s < options.seconds && seconds_since(start) < options.cell_s);
    times.push_back(stepping_s / static_cast<double>(frames));
  } while (times.size() < options.repetitions && seconds_since(start) + first_s < 0.5 * options.cell_s);
  std::sort(times.begin(), times.end());
  cell.least_s = times.front();
  cell.median_s = times[times.size() / 2];
  return cell;
}

std::vector<ScaleCell> measure_cells(const ScaleOptions& options, const std::function<void()>& tick) {
  std::vector<ScaleCell> cells;
  for (const ScaleSeries& series : all_series(options)) {
    Settings settings = settings_of(series, options);
    CellCap cap(options.cell_s);
    for (const std::uint32_t links : options.links) {
      ScaleCell cell{.series = series, .links = links, .sweeps = settings.stop.sweeps};
      if (cap.allows(links)) {
        double first_s = 0;
        cell = measure_cell(series, links, settings, options, first_s);
        // Longer chains do not hold with fewer substeps.
        while (cell.outcome == CellOutcome::broke && settings.substeps < most_substeps) {
          settings.substeps *= 2;
          cell = measure_cell(series, links, settings, options, first_s);
        }
        if (cell.outcome == CellOutcome::too_slow) cap.stop();
        if (cell.measured()) cap.spent(links, first_s * least_frames / cell.frames);
      }
      cells.push_back(cell);
      tick();
    }
  }
  return cells;
}

std::optional<std::uint32_t> find_differing(const std::vector<ScaleCell>& cells) {
  for (const ScaleCell& together : cells) {
    if (!together.series.all_threads || !together.measured()) continue;
    for (const ScaleCell& alone : cells) {
      ScaleSeries series = alone.series;
      series.all_threads = true;
      if (series == together.series && !alone.series.all_threads && alone.links == together.links &&
          alone.measured() && alone.frames == together.frames && alone.state_hash != together.state_hash)
        return together.links;
    }
  }
  return {};
}

std::vector<Timing> timings_of(const std::vector<ScaleCell>& cells, const ScaleSeries& series) {
  std::vector<Timing> out;
  for (const ScaleCell& cell : cells)
    if (cell.series == series && cell.measured()) out.emplace_back(cell.links, cell.least_s);
  return out;
}

}  // namespace plumb::tools
