#include "stability/grid.hpp"

#include <algorithm>
#include <cmath>

#include "plumb/error.hpp"
#include "plumb/measures.hpp"
#include "scenes/basics/clock.hpp"
#include "scenes/basics/lists.hpp"
#include "scenes/basics/numbers.hpp"
#include "scenes/basics/require.hpp"
#include "scenes/generators/generators.hpp"
#include "scenes/runs/counters.hpp"

namespace plumb::scenes {
namespace {

constexpr double rod_length = 0.1;  // Length of a rod, in m.
constexpr std::uint32_t most_links = 10'000'000;

template <class T>
void require_one_of(const std::vector<T>& values, T value, const char* what) {
  std::string list;
  for (const T v : values) append_item(list, short_number(static_cast<double>(v)));
  if (std::find(values.begin(), values.end(), value) == values.end()) {
    throw InputError("no plane at " + std::string(what) + " " + short_number(static_cast<double>(value)) +
                     ": the grid has " + list);
  }
}

void require_grid(const StabilityGrid& grid) {
  if (grid.methods.empty() || grid.ratios.empty() || grid.links.empty() || grid.dts.empty())
    throw InputError("the grid is empty");
  for (const double ratio : grid.ratios) require_positive(ratio, "the end-mass ratio");
  for (const double dt : grid.dts) require_positive(dt, "dt");
  for (const std::uint32_t links : grid.links)
    if (links == 0 || links > most_links)
      throw InputError("links must be from 1 to " + std::to_string(most_links));
  require_positive(grid.duration, "the duration");
  require_one_of(grid.dts, grid.at_dt, "dt");
  require_one_of(grid.links, grid.at_links, "links");
}

/// Keeps the larger value. It is written so that a value that is not a number wins and stays.
void keep_largest(double& largest, double value) {
  if (!(value <= largest) && !std::isnan(largest)) largest = value;
}

bool all_finite(const std::vector<Vec3>& values) {
  return std::all_of(values.begin(), values.end(), is_finite);
}

}  // namespace

const std::vector<StabilityMethod>& all_stability_methods() {
  static const std::vector<StabilityMethod> list = {
      {"relax-old", Method::relax, Gradient::old},
      {"relax-mid", Method::relax, Gradient::mid},
      {"relax-new", Method::relax, Gradient::new_},
      {"relax-jacobi", Method::relax, Gradient::new_, SweepOrder::jacobi},
      {"direct-old", Method::direct, Gradient::old},
      {"direct-mid", Method::direct, Gradient::mid},
      {"direct-new", Method::direct, Gradient::new_},
      {"auto", Method::automatic, {}},
  };
  return list;
}

std::vector<StabilityMethod> default_stability_methods() {
  std::vector<StabilityMethod> out = all_stability_methods();
  std::erase_if(out, [](const StabilityMethod& m) { return m.method == Method::automatic; });
  return out;
}

std::vector<StabilityCase> list_cells(const StabilityGrid& grid) {
  require_grid(grid);
  std::vector<StabilityCase> out;
  for (const StabilityMethod& method : grid.methods) {
    for (const std::uint32_t links : grid.links) {
      for (const double dt : grid.dts) {
        if (!grid.full && links != grid.at_links && dt != grid.at_dt) continue;
        const auto frames = static_cast<std::uint64_t>(std::max(1.0, std::round(grid.duration / dt)));
        for (const double ratio : grid.ratios) out.push_back({method, ratio, links, dt, frames});
      }
    }
  }
  return out;
}

std::string_view to_string(Outcome outcome) {
  switch (outcome) {
    case Outcome::survived:
      return "survived";
    case Outcome::not_finite:
      return "not-finite";
    case Outcome::frozen:
      return "frozen";
    case Outcome::unsolved:
      return "unsolved";
    case Outcome::stretched:
      return "stretched";
    case Outcome::gained_energy:
      return "gained-energy";
    case Outcome::too_slow:
      break;
  }
  return "too-slow";
}

double StabilityResult::ms_per_s() const {
  return 1e3 * wall_s / (cell.dt * static_cast<double>(frames));
}

Outcome judge(const StabilityResult& result) {
  if (!result.finite) return Outcome::not_finite;
  if (result.total.frozen_islands > 0) return Outcome::frozen;
  if (result.total.unsolved > 0) return Outcome::unsolved;
  // The comparisons are negated, so that what overflowed counts too.
  if (!(result.stretch_max <= most_stretch)) return Outcome::stretched;
  if (!(result.energy_gain <= most_gain)) return Outcome::gained_energy;
  return result.frames < result.cell.frames ? Outcome::too_slow : Outcome::survived;
}

StabilityResult measure_stability(const StabilityCase& cell, std::uint32_t sweeps, double budget_s) {
  const auto begin = Clock::now();
  const Scene scene = make_chain(cell.links, rod_length, cell.ratio);
  Settings settings;
  settings.method = cell.method.method;
  settings.order = cell.method.order;
  settings.gradient = cell.method.gradient;
  settings.threads = 1;
  if (settings.method == Method::relax) settings.stop.sweeps = sweeps;
  World world(scene, settings);

  StabilityResult result{.cell = cell};
  std::vector<Vec3> positions(world.particle_count());
  std::vector<Vec3> velocities(world.particle_count());
  const auto energy = [&] {
    world.copy_positions(positions);
    world.copy_velocities(velocities);
    return measure_energy(scene, positions, velocities, mass_model_of(settings)).total() /
           energy_range(scene);
  };
  const double at_first = energy();
  while (result.frames < cell.frames && (result.frames == 0 || seconds_since(begin) < budget_s)) {
    const auto start = Clock::now();
    result.total += world.step(cell.dt);
    result.wall_s += seconds_since(start);
    ++result.frames;
    const double change = energy() - at_first;
    result.finite = result.finite && all_finite(positions) && all_finite(velocities);
    keep_largest(result.energy_gain, change);
    keep_largest(result.energy_drift, std::abs(change));
    keep_largest(result.stretch_max, measure_stretch(scene, positions).max);
  }
  result.outcome = judge(result);
  return result;
}

std::string stability_csv(const std::vector<StabilityResult>& results) {
  std::string csv =
      "method,ratio,links,dt_s,frames,frames_asked,outcome,stretch_max,energy_drift,energy_gain,"
      "ms_per_simulated_s";
  for (const Counter& counter : counters()) append_item(csv, flat_name(counter), ",");
  csv += "\n";
  for (const StabilityResult& r : results) {
    std::string line = r.cell.method.name;
    append_item(line, short_number(r.cell.ratio, 9), ",");
    append_item(line, std::to_string(r.cell.links), ",");
    append_item(line, short_number(r.cell.dt, 9), ",");
    append_item(line, std::to_string(r.frames), ",");
    append_item(line, std::to_string(r.cell.frames), ",");
    append_item(line, to_string(r.outcome), ",");
    for (const double v : {r.stretch_max, r.energy_drift, r.energy_gain})
      append_item(line, short_number(v), ",");
    append_item(line, short_number(r.ms_per_s()), ",");
    for (const Counter& counter : counters()) append_item(line, text_of(counter, r.total), ",");
    csv += line + "\n";
  }
  return csv;
}

}  // namespace plumb::scenes
