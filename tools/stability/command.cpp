// plumb stability shows where each method holds and where it breaks, over end mass, links and step.
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <map>
#include <memory>

#include "cli/commands.hpp"
#include "cli/options.hpp"
#include "cli/progress.hpp"
#include "plot/gnuplot.hpp"
#include "plot/page.hpp"
#include "plumb/error.hpp"
#include "scenes/basics/files.hpp"
#include "scenes/basics/lists.hpp"
#include "scenes/basics/numbers.hpp"
#include "stability/hangings_report.hpp"
#include "stability/picture.hpp"

namespace plumb::tools {
namespace {

using scenes::append_item;
using scenes::Outcome;
using scenes::short_number;
using scenes::StabilityGrid;
using scenes::StabilityMethod;
using scenes::StabilityResult;

struct StabilityOptions {
  StabilityGrid grid;
  std::optional<double> at_dt;
  std::optional<std::uint32_t> at_links;
  std::uint32_t sweeps = 20;
  double budget_s = 2;
  std::string out = "out";
  std::uint32_t hangings = 0;  ///< So many random hangings are measured instead, if any.
  std::uint32_t seed = 1;
  bool quiet = false;
  std::string typed;  ///< Options that the page repeats, as the user typed them.
};

/// Returns the value asked for, or `usual` if the grid has it, or the last.
template <class T>
T plane_at(const std::optional<T>& asked, const std::vector<T>& values, T usual) {
  if (asked) return *asked;
  return std::find(values.begin(), values.end(), usual) != values.end() || values.empty() ? usual
                                                                                          : values.back();
}

template <class T>
void sort_unique(std::vector<T>& values) {
  std::sort(values.begin(), values.end());
  values.erase(std::unique(values.begin(), values.end()), values.end());
}

/// Adds an option that takes positive numbers separated by commas.
template <class T, class Parse>
void add_list(Command& command, const std::string& name, std::vector<T>& target, Parse parse,
              const std::string& help) {
  const auto take = [&target, parse](const std::string& text) {
    std::vector<T> values;
    for (const std::string& item : scenes::split_list(text)) {
      const auto value = parse(item);
      if (!value || !(*value > 0))
        throw BadValue("'" + item + "' is not a positive " +
                       (std::is_integral_v<T> ? "whole number" : "number"));
      values.push_back(*value);
    }
    sort_unique(values);
    target = std::move(values);
  };
  command.add_option(name, "X1,X2,...", take, help);
}

std::vector<StabilityMethod> parse_pairs(const std::string& text) {
  std::vector<StabilityMethod> out;
  for (const std::string& item : scenes::split_list(text)) {
    std::string known;
    const auto& all = scenes::all_stability_methods();
    const auto it = std::find_if(all.begin(), all.end(), [&](const StabilityMethod& m) {
      append_item(known, m.name);
      return m.name == item;
    });
    if (it == all.end()) throw BadValue("'" + item + "' is not one of " + known);
    if (std::none_of(out.begin(), out.end(), [&](const StabilityMethod& m) { return m.name == item; }))
      out.push_back(*it);
  }
  return out;
}

/// Returns a row per method. The worst values are over the cells that survived.
Table summary_table(const StabilityGrid& grid, const std::vector<StabilityResult>& results) {
  Table table({"method", "cells", "survived", "too slow", "worst stretch", "worst drift", "halvings",
               "fallbacks", "unsolved", "most ms per s"});
  for (const StabilityMethod& method : grid.methods) {
    std::uint64_t cells = 0, survived = 0, slow = 0;
    double stretch = 0, drift = 0, cost = 0;
    StepReport total;
    for (const StabilityResult& r : results) {
      if (r.cell.method.name != method.name) continue;
      ++cells;
      total += r.total;
      cost = std::max(cost, r.ms_per_s());
      slow += r.outcome == Outcome::too_slow;
      if (r.outcome != Outcome::survived) continue;
      ++survived;
      stretch = std::max(stretch, r.stretch_max);
      drift = std::max(drift, r.energy_drift);
    }
    const auto worst = [&](double value) { return survived ? short_number(value, 2) : std::string("-"); };
    table.add_row({method.name, std::to_string(cells), std::to_string(survived), std::to_string(slow),
                   worst(stretch), worst(drift), std::to_string(total.halvings),
                   std::to_string(total.fallbacks), std::to_string(total.unsolved),
                   scenes::plain_number(cost, 2)});
  }
  return table;
}

/// Says why cells did not survive, with a row per method and a column per outcome that occurs.
Table outcome_table(const StabilityGrid& grid, const std::vector<StabilityResult>& results) {
  std::map<Outcome, std::map<std::string, std::uint64_t>> counts;
  for (const StabilityResult& r : results) ++counts[r.outcome][r.cell.method.name];
  std::vector<std::string> header{"method"};
  for (const auto& [outcome, by_method] : counts) header.emplace_back(to_string(outcome));
  Table table(header);
  for (const StabilityMethod& method : grid.methods) {
    std::vector<std::string> row{method.name};
    for (auto& [outcome, by_method] : counts) row.push_back(std::to_string(by_method[method.name]));
    table.add_row(row);
  }
  return table;
}

std::string stability_text(const StabilityOptions& options) {
  return "Straight chains, horizontal at first, swing about one fixed end: rods of 10 cm, 1 kg a particle "
         "but the "
         "last. One thread, double, no substeps; relaxation with " +
         std::to_string(options.sweeps) +
         " sweeps a step. A cell survives if its state stays finite, no island is frozen, no substep stays "
         "unsolved, no rod is ever stretched by more than " +
         short_number(100 * scenes::most_stretch) + " % and energy never rises by more than " +
         short_number(100 * scenes::most_gain) +
         " % of its range, which is what falling through the whole chain gives. Cells that took more than " +
         short_number(options.budget_s) +
         " s of wall-clock time are too slow, which depends on the machine and on what else it does.";
}

void publish(const StabilityOptions& options, const std::vector<StabilityResult>& results) {
  const std::filesystem::path folder = options.out;
  const StabilityGrid& grid = options.grid;
  scenes::write_file(folder / "stability.csv", scenes::stability_csv(results));
  scenes::Machine machine = scenes::describe_machine();
  machine.threads = 1;
  Section section("stability", "Stability: heavy ends, links and steps", "plumb stability" + options.typed,
                  machine);
  section.add_text(stability_text(options));
  section.add_table(summary_table(grid, results));
  section.add_text("Worst stretch and drift are of the cells that survived. Every cell is in stability.csv.");
  section.add_table(outcome_table(grid, results));
  for (const StabilityQuantity quantity : {StabilityQuantity::stretch, StabilityQuantity::energy}) {
    const bool stretch = quantity == StabilityQuantity::stretch;
    section.add_heading(stretch ? "Stretch" : "Energy");
    const std::string suffix = stretch ? "stretch" : "energy";
    section.add_svg(folder, "stability_links_" + suffix, draw_svg(map_of_links(grid, results, quantity)));
    section.add_svg(folder, "stability_steps_" + suffix, draw_svg(map_of_steps(grid, results, quantity)));
  }
  section.publish(folder);
  section.publish_alone(folder);
}

int stability(StabilityOptions options) {
  if (options.hangings > 0) {
    report_hangings(options.hangings, options.seed, options.grid.duration);
    return fine;
  }
  StabilityGrid& grid = options.grid;
  grid.at_dt = plane_at(options.at_dt, grid.dts, StabilityGrid{}.at_dt);
  grid.at_links = plane_at(options.at_links, grid.links, StabilityGrid{}.at_links);
  if (options.sweeps == 0) throw InputError("--sweeps must be at least 1");
  const std::vector<scenes::StabilityCase> cells = list_cells(grid);
  require_gnuplot();
  make_folder(options.out);
  std::vector<StabilityResult> results;
  {
    Progress progress("measuring", options.quiet);
    for (const scenes::StabilityCase& cell : cells) {
      results.push_back(scenes::measure_stability(cell, options.sweeps, options.budget_s));
      progress.show(results.size(), cells.size());
    }
  }
  std::printf("%s\n\n%s\n%s", stability_text(options).c_str(), summary_table(grid, results).to_text().c_str(),
              outcome_table(grid, results).to_text().c_str());
  publish(options, results);
  if (!options.quiet) std::printf("\nPage: %s/stability.html\n", options.out.c_str());
  return fine;
}

}  // namespace

void add_stability_command(Command& plumb) {
  Command command = plumb.add_command("stability", "Map where methods hold and break: end mass, links, step");
  auto options = std::make_shared<StabilityOptions>();
  StabilityOptions& o = *options;
  // It is declared before the lists, so that these can still be given.
  const Option quick = command.add_flag(
      "--quick",
      [&o] {
        o.grid.ratios = {1, 100, 1e4, 1e6};
        o.grid.links = {5, 20, 100};
        o.grid.dts = {0.003, 1.0 / 60, 0.1};
        o.grid.duration = 2;
      },
      "A few seconds: every other ratio, up to 100 links, three steps, two simulated seconds");
  command.add_flag("--full", o.grid.full, "Every combination, not only the two planes drawn: many minutes")
      .excludes(quick);
  std::string words;
  for (const StabilityMethod& method : scenes::all_stability_methods()) append_item(words, method.name, "|");
  command.add_option(
      "--methods", "M1,M2,...", [&o](const std::string& text) { o.grid.methods = parse_pairs(text); },
      "Of " + words + ", separated by commas [all but auto]");
  add_list(command, "--ratios", o.grid.ratios, scenes::parse_number<double>,
           "Mass of the last particle to that of each other [1,10,...,1e6]");
  add_list(command, "--links", o.grid.links, scenes::parse_number<std::uint32_t>,
           "Lengths of chain [5,20,100,1000,10000]");
  add_list(command, "--dt", o.grid.dts, scenes::parse_fraction,
           "Steps in seconds [0.001,0.003,0.01,1/60,0.033,0.1]");
  const auto take_dt = [&o](const std::string& text) {
    o.at_dt = scenes::parse_fraction(text);
    if (!o.at_dt) throw BadValue("'" + text + "' is not a finite number");
  };
  command.add_option("--at-dt", "S", take_dt,
                     "Step of the map over links, one of --dt [1/60, or else the longest]");
  const auto take_links = [&o](const std::string& text) {
    o.at_links = scenes::parse_number<std::uint32_t>(text);
    if (!o.at_links) throw BadValue("'" + text + "' is not a whole number");
  };
  command.add_option("--at-links", "N", take_links,
                     "Links of the map over steps, one of --links [100, or else the longest]");
  add_seconds(command, "--duration", o.grid.duration, "Simulated time, rounded to whole steps [3]");
  add_count(command, "--sweeps", o.sweeps, "Passes of relaxation over all rods a step [20]");
  add_seconds(command, "--budget", o.budget_s, "Most wall-clock time for a cell; above, it is too slow [2]");
  command.add_option("--out", "DIR", o.out,
                     "Write stability.csv, stability.html and pictures into this folder [out]");
  add_count(command, "--hangings", o.hangings,
            "Instead of the map, hang up so many random lines, nets, bridges, cranes and others");
  add_count(command, "--seed", o.seed, "Seed of the first of them; the others follow [1]");
  command.add_flag("--quiet", o.quiet, "No progress bar");
  command.set_footer(
      "A cell survives if its state stays finite, no island is frozen, no substep stays unsolved, no rod is "
      "ever stretched\nby more than 50 % and energy never rises by more than its range.\n\nExamples:\n"
      "  plumb stability\n  plumb stability --hangings 1000\n"
      "  plumb stability --quick --methods relax-new,direct-mid\n"
      "  plumb stability --full --budget 10 --out out-full\n"
      "  plumb stability --links 20 --ratios 1,1000 --dt 1/240,1/60 --methods direct-mid");
  command.set_action([options, command] {
    options->typed = command.typed();
    return stability(*options);
  });
}

}  // namespace plumb::tools
