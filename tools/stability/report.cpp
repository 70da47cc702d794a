#include "stability/report.hpp"

#include <algorithm>
#include <filesystem>
#include <map>

#include "plot/page.hpp"
#include "scenes/basics/files.hpp"
#include "scenes/basics/numbers.hpp"

namespace plumb::tools {
namespace {

using scenes::Outcome;
using scenes::short_number;
using scenes::StabilityGrid;
using scenes::StabilityMethod;
using scenes::StabilityResult;
using scenes::StabilityScene;

std::vector<std::string> summary_row(const MeasuredGrid& measured, const StabilityMethod& method) {
  std::uint64_t cells = 0, survived = 0, slow = 0;
  double stretch = 0, drift = 0, depth = 0, cost = 0;
  StepReport total;
  for (const StabilityResult& r : measured.results) {
    if (r.cell.method.name != method.name) continue;
    ++cells;
    total += r.total;
    cost = std::max(cost, r.ms_per_s());
    slow += r.outcome == Outcome::too_slow;
    if (r.outcome != Outcome::survived) continue;
    ++survived;
    stretch = std::max(stretch, r.stretch_max);
    depth = std::max(depth, r.depth_max);
    drift = std::max(drift, r.energy_drift);
  }
  const auto worst = [&](double value) { return survived ? short_number(value, 2) : std::string(no_value); };
  const bool lands = scenes::is_landing(measured.grid.scene);
  return {std::string(to_string(measured.grid.scene)),
          method.name,
          std::to_string(cells),
          std::to_string(survived),
          std::to_string(slow),
          worst(stretch),
          lands ? worst(depth) : no_value,
          worst(drift),
          std::to_string(total.halvings),
          std::to_string(total.fallbacks),
          std::to_string(total.unsolved),
          scenes::plain_number(cost, 2)};
}

/// Adds the two planes of chains or nets.
void add_hanging(Section& section, const std::string& folder, const MeasuredGrid& measured) {
  const bool nets = measured.grid.scene == StabilityScene::nets;
  const std::string name = nets ? "stability_nets_" : "stability_";
  for (const StabilityQuantity quantity : {StabilityQuantity::stretch, StabilityQuantity::energy}) {
    const bool stretch = quantity == StabilityQuantity::stretch;
    const std::string suffix = stretch ? "_stretch" : "_energy";
    section.add_heading(std::string(nets ? "Nets: " : "Chains: ") + (stretch ? "stretch" : "energy"));
    section.add_svg(folder, name + "links" + suffix, draw_svg(map_of_sizes(measured, quantity)));
    section.add_svg(folder, name + "steps" + suffix, draw_svg(map_of_steps(measured, quantity)));
  }
}

}  // namespace

std::string StabilityReport::text() const {
  return "Straight chains, horizontal at first, swing about one fixed end, and slack nets fall from two "
         "corners: rods of 10 cm, 1 kg a particle but the last. Springs are so stiff that the weight of all "
         "stretches one by " +
         short_number(100 * scenes::give_of_springs) +
         " %. Ropes are thrown down on a plane, nets on a sphere, and boxes on a plane and each other. One "
         "thread, double, no substeps; relaxation with " +
         std::to_string(sweeps) +
         " sweeps a step. A cell survives if its state stays finite, no island is frozen, no substep stays "
         "unsolved, no rod is ever stretched by more than " +
         short_number(100 * scenes::most_stretch) +
         " % and energy never rises by more than its range, which is what falling through the whole chain "
         "gives. What lands gains at most a hundredth of its range and kinetic energy, and is nowhere deeper "
         "in the ground than half a capsule's radius, or a quarter of a box's side. Cells that took more "
         "than " +
         short_number(budget_s) +
         " s of wall-clock time are too slow, which depends on the machine and on what else it does.";
}

Table StabilityReport::summary() const {
  Table table({"scene", "method", "cells", "survived", "too slow", "worst stretch", "worst depth",
               "worst drift", "halvings", "fallbacks", "unsolved", "most ms per s"});
  for (const MeasuredGrid& each : grids)
    for (const StabilityMethod& method : each.grid.methods) table.add_row(summary_row(each, method));
  return table;
}

Table StabilityReport::outcomes() const {
  using Row = std::pair<StabilityScene, std::string>;
  std::map<Outcome, std::map<Row, std::uint64_t>> counts;
  for (const MeasuredGrid& each : grids)
    for (const StabilityResult& r : each.results) ++counts[r.outcome][{r.cell.scene, r.cell.method.name}];
  std::vector<std::string> header{"scene", "method"};
  for (const auto& [outcome, by_method] : counts) header.emplace_back(to_string(outcome));
  Table table(header);
  for (const MeasuredGrid& each : grids)
    for (const StabilityMethod& method : each.grid.methods) {
      std::vector<std::string> row{std::string(to_string(each.grid.scene)), method.name};
      for (auto& [outcome, by_method] : counts)
        row.push_back(std::to_string(by_method[{each.grid.scene, method.name}]));
      table.add_row(row);
    }
  return table;
}

void StabilityReport::publish(const std::string& folder) const {
  std::vector<StabilityResult> all;
  std::vector<MeasuredGrid> landings;
  for (const MeasuredGrid& each : grids) {
    all.insert(all.end(), each.results.begin(), each.results.end());
    if (scenes::is_landing(each.grid.scene)) landings.push_back(each);
  }
  scenes::write_file(std::filesystem::path(folder) / "stability.csv", scenes::stability_csv(all));
  scenes::Machine machine = scenes::describe_machine();
  machine.threads = 1;
  Section section("stability", "Stability: heavy ends, sizes, speeds and steps", "plumb stability" + typed,
                  machine);
  section.add_text(text());
  section.add_table(summary());
  section.add_text("Worst values are of the cells that survived. Every cell is in stability.csv.");
  section.add_table(outcomes());
  for (const MeasuredGrid& each : grids)
    if (!scenes::is_landing(each.grid.scene)) add_hanging(section, folder, each);
  if (!landings.empty()) {
    section.add_heading("Landings: depth and stretch");
    section.add_svg(folder, "stability_landings_depth",
                    draw_svg(map_of_landings(landings, StabilityQuantity::depth)));
    section.add_svg(folder, "stability_landings_stretch",
                    draw_svg(map_of_landings(landings, StabilityQuantity::stretch)));
  }
  section.publish_alone(folder);
  section.publish(folder);
}

}  // namespace plumb::tools
