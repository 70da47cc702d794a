#include "stability/picture.hpp"

#include <algorithm>

#include "scenes/basics/numbers.hpp"

namespace plumb::tools {
namespace {

using scenes::Outcome;
using scenes::short_number;
using scenes::StabilityGrid;
using scenes::StabilityResult;

template <class T>
std::size_t place_of(const std::vector<T>& values, T value) {
  return static_cast<std::size_t>(std::find(values.begin(), values.end(), value) - values.begin());
}

std::string milliseconds(double seconds) {
  return short_number(1e3 * seconds, 3);
}

/// Spells 10000 as 1e4, so that seven such numbers fit under a panel.
std::string ratio_text(double ratio) {
  std::string text = short_number(ratio, 3);
  if (const std::size_t plus = text.find("e+0"); plus != std::string::npos) text.erase(plus + 1, 2);
  return text;
}

double value_of(const StabilityResult& result, StabilityQuantity quantity) {
  switch (quantity) {
    case StabilityQuantity::stretch:
      return result.stretch_max;
    case StabilityQuantity::depth:
      return result.depth_max;
    case StabilityQuantity::energy:
      break;
  }
  return result.energy_drift;
}

HeatMap blank_map(const StabilityGrid& grid, StabilityQuantity quantity) {
  HeatMap map;
  map.x = scenes::is_landing(grid.scene) ? "speed, m/s" : "mass of the last particle to that of each other";
  map.quantity = quantity == StabilityQuantity::stretch ? "worst stretch of a rod, of its length"
                 : quantity == StabilityQuantity::depth ? "worst depth in ground, of a radius or half a side"
                                                        : "worst drift of energy, of its range";
  map.least = quantity == StabilityQuantity::energy ? -8 : -6;
  map.crossed = "did not survive";
  map.missing = "too slow";
  for (const double each : grid.severities) map.columns.push_back(ratio_text(each));
  return map;
}

/// Makes one panel per method, with the results that `takes` and the row that `row_of` gives them.
template <class Takes, class RowOf>
void add_panels(HeatMap& map, const MeasuredGrid& measured, StabilityQuantity quantity, Takes takes,
                RowOf row_of) {
  const StabilityGrid& grid = measured.grid;
  for (const scenes::StabilityMethod& method : grid.methods) {
    HeatPanel panel{.title = method.name, .cells = {}};
    if (scenes::is_landing(grid.scene)) panel.title = std::string(to_string(grid.scene)) + ", " + panel.title;
    std::replace(panel.title.begin(), panel.title.end(), '-', ' ');
    for (const StabilityResult& r : measured.results) {
      if (r.cell.method.name != method.name || !takes(r)) continue;
      const bool slow = r.outcome == Outcome::too_slow;
      panel.cells.push_back({.column = place_of(grid.severities, r.cell.severity),
                             .row = row_of(r),
                             .value = value_of(r, quantity),
                             .crossed = r.outcome != Outcome::survived && !slow,
                             .missing = slow});
    }
    map.panels.push_back(std::move(panel));
  }
}

void add_step_panels(HeatMap& map, const MeasuredGrid& measured, StabilityQuantity quantity) {
  const StabilityGrid& grid = measured.grid;
  add_panels(
      map, measured, quantity, [&](const StabilityResult& r) { return r.cell.size == grid.at_size; },
      [&](const StabilityResult& r) { return place_of(grid.dts, r.cell.dt); });
}

HeatMap blank_steps(const StabilityGrid& grid, StabilityQuantity quantity) {
  HeatMap map = blank_map(grid, quantity);
  map.y = "step, ms";
  for (const double dt : grid.dts) map.rows.push_back(milliseconds(dt));
  return map;
}

}  // namespace

HeatMap map_of_sizes(const MeasuredGrid& measured, StabilityQuantity quantity) {
  const StabilityGrid& grid = measured.grid;
  const bool nets = grid.scene == scenes::StabilityScene::nets;
  HeatMap map = blank_map(grid, quantity);
  map.title = std::string(nets ? "Nets: heavy corners against size" : "Heavy ends against links") +
              ", steps of " + milliseconds(grid.at_dt) + " ms";
  map.y = nets ? "particles along a side" : "links";
  for (const std::uint32_t size : grid.sizes) map.rows.push_back(std::to_string(size));
  add_panels(
      map, measured, quantity, [&](const StabilityResult& r) { return r.cell.dt == grid.at_dt; },
      [&](const StabilityResult& r) { return place_of(grid.sizes, r.cell.size); });
  return map;
}

HeatMap map_of_steps(const MeasuredGrid& measured, StabilityQuantity quantity) {
  const StabilityGrid& grid = measured.grid;
  HeatMap map = blank_steps(grid, quantity);
  const std::string size = std::to_string(grid.at_size);
  map.title = grid.scene == scenes::StabilityScene::nets
                  ? "Nets: heavy corners against the step, " + size + " x " + size + " particles"
                  : "Heavy ends against the step, chains of " + size + " links";
  add_step_panels(map, measured, quantity);
  return map;
}

HeatMap map_of_landings(std::span<const MeasuredGrid> landings, StabilityQuantity quantity) {
  HeatMap map = blank_steps(landings.front().grid, quantity);
  map.title = "Landings: speed against the step";
  for (const MeasuredGrid& each : landings) add_step_panels(map, each, quantity);
  return map;
}

}  // namespace plumb::tools
