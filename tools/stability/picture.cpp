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

HeatMap blank_map(const StabilityGrid& grid, StabilityQuantity quantity) {
  const bool stretch = quantity == StabilityQuantity::stretch;
  HeatMap map;
  map.x = "mass of the last particle to that of each other";
  map.quantity = stretch ? "worst stretch of a rod, of its length" : "worst drift of energy, of its range";
  map.least = stretch ? -6 : -8;
  map.crossed = "did not survive";
  map.missing = "too slow";
  for (const double ratio : grid.ratios) map.columns.push_back(ratio_text(ratio));
  return map;
}

/// Makes one panel per method, with the results that `takes` and the row that `row_of` gives them.
template <class Takes, class RowOf>
void add_panels(HeatMap& map, const StabilityGrid& grid, const std::vector<StabilityResult>& results,
                StabilityQuantity quantity, Takes takes, RowOf row_of) {
  for (const scenes::StabilityMethod& method : grid.methods) {
    HeatPanel panel{.title = method.name, .cells = {}};
    std::replace(panel.title.begin(), panel.title.end(), '-', ' ');
    for (const StabilityResult& r : results) {
      if (r.cell.method.name != method.name || !takes(r)) continue;
      const bool slow = r.outcome == Outcome::too_slow;
      panel.cells.push_back({.column = place_of(grid.ratios, r.cell.ratio),
                             .row = row_of(r),
                             .value = quantity == StabilityQuantity::stretch ? r.stretch_max : r.energy_drift,
                             .crossed = r.outcome != Outcome::survived && !slow,
                             .missing = slow});
    }
    map.panels.push_back(std::move(panel));
  }
}

}  // namespace

HeatMap map_of_links(const StabilityGrid& grid, const std::vector<StabilityResult>& results,
                     StabilityQuantity quantity) {
  HeatMap map = blank_map(grid, quantity);
  map.title = "Heavy ends against links, steps of " + milliseconds(grid.at_dt) + " ms";
  map.y = "links";
  for (const std::uint32_t links : grid.links) map.rows.push_back(std::to_string(links));
  add_panels(
      map, grid, results, quantity, [&](const StabilityResult& r) { return r.cell.dt == grid.at_dt; },
      [&](const StabilityResult& r) { return place_of(grid.links, r.cell.links); });
  return map;
}

HeatMap map_of_steps(const StabilityGrid& grid, const std::vector<StabilityResult>& results,
                     StabilityQuantity quantity) {
  HeatMap map = blank_map(grid, quantity);
  map.title = "Heavy ends against the step, chains of " + std::to_string(grid.at_links) + " links";
  map.y = "step, ms";
  for (const double dt : grid.dts) map.rows.push_back(milliseconds(dt));
  add_panels(
      map, grid, results, quantity, [&](const StabilityResult& r) { return r.cell.links == grid.at_links; },
      [&](const StabilityResult& r) { return place_of(grid.dts, r.cell.dt); });
  return map;
}

}  // namespace plumb::tools
