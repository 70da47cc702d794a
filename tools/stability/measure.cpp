#include <algorithm>
#include <cmath>
#include <limits>

#include "plumb/measures.hpp"
#include "scenes/basics/clock.hpp"
#include "scenes/basics/lists.hpp"
#include "scenes/basics/numbers.hpp"
#include "scenes/generators/falling.hpp"
#include "scenes/generators/generators.hpp"
#include "scenes/runs/counters.hpp"
#include "scenes/runs/depth.hpp"
#include "scenes/shots/cores.hpp"
#include "stability/grid.hpp"

namespace plumb::scenes {
namespace {

constexpr double link_length = 0.1;  // Length of a rod of what hangs, in m.
constexpr double net_slack = 0.1;
constexpr double start_height = 0.05;  // Of what lands, in m.

/// Keeps the larger value. It is written so that a value that is not a number wins and stays.
void keep_largest(double& largest, double value) {
  if (!(value <= largest) && !std::isnan(largest)) largest = value;
}

bool all_finite(const std::vector<Vec3>& values) {
  return std::all_of(values.begin(), values.end(), is_finite);
}

Settings settings_of(const StabilityCase& cell, const Scene& scene, std::uint32_t sweeps) {
  const StabilityMethod& method = cell.method;
  Settings settings{
      .method = method.method, .gradient = method.gradient, .order = method.order, .threads = 1};
  if (settings.method == Method::relax) settings.stop.sweeps = sweeps;
  if (settings.method == Method::springs) {
    double mass = 0;
    for (const Particle& each : scene.particles) mass += each.fixed ? 0 : each.mass;
    settings.integrator = method.integrator;
    settings.mass = MassModel::lumped;
    settings.springs = {.model = SpringModel::particles,
                        .stiffness = mass * norm(scene.gravity) / (give_of_springs * link_length),
                        .damping_ratio = method.integrator == Integrator::implicit_euler ? 1 : 0.05};
  }
  return settings;
}

/// Returns the least radius of a capsule, or half of the shortest side of a box, in m.
double thickness_of(const Scene& scene) {
  double least = std::numeric_limits<double>::infinity();
  for (const Capsule& each : scene.capsules) least = std::min(least, each.radius);
  for (const Hull& each : scene.hulls)
    for (const double side : half_sides(each)) least = std::min(least, side);
  return least;
}

}  // namespace

Scene make_stability_scene(const StabilityCase& cell) {
  Scene scene;
  switch (cell.scene) {
    case StabilityScene::chains:
      return make_chain(cell.size, link_length, cell.severity);
    case StabilityScene::nets:
      return make_net({.width = cell.size,
                       .height = cell.size,
                       .spacing = link_length,
                       .slack = net_slack,
                       .end_mass = cell.severity});
    case StabilityScene::ropes:
      scene = make_rope({.links = cell.size, .height = start_height});
      break;
    case StabilityScene::drapes:
      scene = make_drape({.size = cell.size, .height = start_height, .sphere = 1});
      break;
    case StabilityScene::boxes:
      scene = make_boxes({.boxes = cell.size, .height = start_height});
      break;
  }
  for (Particle& each : scene.particles) each.velocity = {0, -cell.severity, 0};
  return scene;
}

double most_gain_of(StabilityScene scene) {
  return is_landing(scene) ? 0.01 : 1;
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
    case Outcome::sank:
      return "sank";
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
  if (!(result.depth_max <= most_depth)) return Outcome::sank;
  if (!(result.energy_gain <= most_gain_of(result.cell.scene))) return Outcome::gained_energy;
  return result.frames < result.cell.frames ? Outcome::too_slow : Outcome::survived;
}

StabilityResult measure_stability(const StabilityCase& cell, std::uint32_t sweeps, double budget_s) {
  const auto begin = Clock::now();
  const Scene scene = make_stability_scene(cell);
  const Settings settings = settings_of(cell, scene, sweeps);
  World world(scene, settings);

  StabilityResult result{.cell = cell};
  std::vector<Vec3> positions(world.particle_count());
  std::vector<Vec3> velocities(world.particle_count());
  const auto energy = [&] {
    world.copy_positions(positions);
    world.copy_velocities(velocities);
    return measure_energy(scene, positions, velocities, mass_model_of(settings));
  };
  const Energy at_first = energy();
  const double range = energy_range(scene) + at_first.kinetic, thickness = thickness_of(scene);
  while (result.frames < cell.frames && (result.frames == 0 || seconds_since(begin) < budget_s)) {
    const auto start = Clock::now();
    result.total += world.step(cell.dt);
    result.wall_s += seconds_since(start);
    ++result.frames;
    const double change = (energy().total() - at_first.total()) / range;
    result.finite = result.finite && all_finite(positions) && all_finite(velocities);
    keep_largest(result.energy_gain, change);
    keep_largest(result.energy_drift, std::abs(change));
    keep_largest(result.stretch_max, measure_stretch(scene, positions).max);
    if (is_landing(cell.scene)) keep_largest(result.depth_max, depth_in_ground(scene, positions) / thickness);
    if (!result.finite || result.total.frozen_islands > 0) break;
  }
  result.outcome = judge(result);
  return result;
}

std::string stability_csv(const std::vector<StabilityResult>& results) {
  std::string csv =
      "scene,method,ratio,speed_m_s,size,dt_s,frames,frames_asked,outcome,stretch_max,depth_max,"
      "energy_drift,energy_gain,"
      "ms_per_simulated_s";
  for (const Counter& counter : counters()) append_item(csv, flat_name(counter), ",");
  csv += "\n";
  for (const StabilityResult& r : results) {
    const bool lands = is_landing(r.cell.scene);
    const std::string severity = short_number(r.cell.severity, 9);
    std::string line(to_string(r.cell.scene));
    append_item(line, r.cell.method.name, ",");
    append_item(line, lands ? "" : severity, ",");
    append_item(line, lands ? severity : "", ",");
    append_item(line, std::to_string(r.cell.size), ",");
    append_item(line, short_number(r.cell.dt, 9), ",");
    append_item(line, std::to_string(r.frames), ",");
    append_item(line, std::to_string(r.cell.frames), ",");
    append_item(line, to_string(r.outcome), ",");
    for (const double v : {r.stretch_max, r.depth_max, r.energy_drift, r.energy_gain})
      append_item(line, short_number(v), ",");
    append_item(line, short_number(r.ms_per_s()), ",");
    for (const Counter& counter : counters()) append_item(line, text_of(counter, r.total), ",");
    csv += line + "\n";
  }
  return csv;
}

}  // namespace plumb::scenes
