// plumb stability shows where each method holds and where it breaks: what hangs over end mass, size and step,
// what lands over speed and step, and random hangings and shots.
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <memory>

#include "cli/commands.hpp"
#include "cli/options.hpp"
#include "cli/progress.hpp"
#include "plot/gnuplot.hpp"
#include "plot/page.hpp"
#include "plumb/error.hpp"
#include "scenes/basics/lists.hpp"
#include "scenes/basics/numbers.hpp"
#include "stability/hangings/hangings_report.hpp"
#include "stability/report.hpp"
#include "stability/shots/shots_report.hpp"

namespace plumb::tools {
namespace {

using scenes::append_item;
using scenes::StabilityGrid;
using scenes::StabilityMethod;
using scenes::StabilityScene;

const std::vector<StabilityScene> all_scenes = {StabilityScene::chains, StabilityScene::nets,
                                                StabilityScene::ropes, StabilityScene::drapes,
                                                StabilityScene::boxes};

struct StabilityOptions {
  std::vector<StabilityScene> scenes = all_scenes;
  bool quick = false, full = false;
  // What is not given stands for what the grid of each scene has.
  std::vector<StabilityMethod> methods{};
  std::vector<double> ratios{}, speeds{}, dts{};
  std::vector<std::uint32_t> links{}, sizes{};
  std::optional<double> at_dt{}, duration{};
  std::optional<std::uint32_t> at_links{};
  StabilityReport report{};
  std::string out = "out";
  std::uint32_t hangings = 0;                    ///< So many random hangings are measured instead, if any.
  std::optional<std::uint32_t> shots{}, shot{};  ///< So many random shots are fired instead, or this one.
  std::uint32_t seed = 1, threads = 0;
  bool quiet = false;
};

/// Returns the value asked for, or `usual` if the grid has it, or the last.
template <class T>
T plane_at(const std::optional<T>& asked, const std::vector<T>& values, T usual) {
  if (asked) return *asked;
  return std::find(values.begin(), values.end(), usual) != values.end() || values.empty() ? usual
                                                                                          : values.back();
}

template <class T>
void take_given(const std::vector<T>& given, std::vector<T>& target) {
  if (!given.empty()) target = given;
}

void quicken(StabilityGrid& grid) {
  const bool hangs_alone = grid.scene == StabilityScene::chains;
  if (scenes::is_landing(grid.scene))
    grid.severities = {1, 10, 100};
  else
    grid.severities = {1, 100, 1e4, 1e6};
  if (hangs_alone) grid.sizes = {5, 20, 100};
  if (grid.scene == StabilityScene::nets) grid.sizes = {4, 8};
  grid.dts = {0.003, 1.0 / 60, 0.1};
  grid.duration = hangs_alone ? 2 : scenes::is_landing(grid.scene) ? 0.5 : 1;
}

/// Returns the grid of a scene as the user wants it; without methods if none of those asked for moves it.
StabilityGrid grid_of(StabilityScene scene, const StabilityOptions& options) {
  StabilityGrid grid = scenes::default_grid(scene);
  if (options.quick) quicken(grid);
  const bool lands = scenes::is_landing(scene);
  if (!options.methods.empty()) {
    const std::vector<StabilityMethod> fit = scenes::landing_methods();
    grid.methods = options.methods;
    std::erase_if(grid.methods, [&](const StabilityMethod& m) {
      return lands &&
             std::none_of(fit.begin(), fit.end(), [&](const StabilityMethod& f) { return f.name == m.name; });
    });
  }
  take_given(lands ? options.speeds : options.ratios, grid.severities);
  if (scene == StabilityScene::chains) take_given(options.links, grid.sizes);
  if (scene == StabilityScene::nets) take_given(options.sizes, grid.sizes);
  take_given(options.dts, grid.dts);
  if (options.duration) grid.duration = *options.duration;
  grid.full = options.full;
  grid.at_dt = plane_at(options.at_dt, grid.dts, grid.at_dt);
  const bool chains = scene == StabilityScene::chains;
  grid.at_size = plane_at(chains ? options.at_links : std::nullopt, grid.sizes, grid.at_size);
  return grid;
}

int measure_grids(StabilityOptions options) {
  StabilityReport& report = options.report;
  if (report.sweeps == 0) throw InputError("--sweeps must be at least 1");
  std::vector<std::vector<scenes::StabilityCase>> cells;
  std::size_t count = 0, done = 0;
  for (const StabilityScene scene : options.scenes) {
    const StabilityGrid grid = grid_of(scene, options);
    if (grid.methods.empty()) continue;
    cells.push_back(list_cells(grid));
    count += cells.back().size();
    report.grids.push_back({grid});
  }
  if (report.grids.empty()) throw InputError("none of these methods moves such scenes");
  require_gnuplot();
  make_folder(options.out);
  {
    Progress progress("measuring", options.quiet);
    for (std::size_t i = 0; i < cells.size(); ++i)
      for (const scenes::StabilityCase& cell : cells[i]) {
        report.grids[i].results.push_back(scenes::measure_stability(cell, report.sweeps, report.budget_s));
        progress.show(++done, count);
      }
  }
  std::printf("%s\n\n%s\n%s", report.text().c_str(), report.summary().to_text().c_str(),
              report.outcomes().to_text().c_str());
  report.publish(options.out);
  if (!options.quiet) std::printf("\nPage: %s/stability.html\n", options.out.c_str());
  return fine;
}

int stability(const StabilityOptions& options) {
  if (options.hangings > 0)
    report_hangings(options.hangings, options.seed, options.duration.value_or(3));
  else if (options.shots || options.shot)
    report_shots({options.shots.value_or(0), options.shot, options.seed, options.threads, options.quiet});
  else
    return measure_grids(options);
  return fine;
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
    std::sort(values.begin(), values.end());
    values.erase(std::unique(values.begin(), values.end()), values.end());
    target = std::move(values);
  };
  command.add_option(name, "X1,X2,...", take, help);
}

/// Returns those of `all` that a list names, each once.
template <class Item, class NameOf>
std::vector<Item> chosen(const std::string& list, const std::vector<Item>& all, NameOf name_of) {
  std::vector<Item> out;
  try {
    for (const Item& item : scenes::named(list, all, name_of))
      if (std::none_of(out.begin(), out.end(), [&](const Item& o) { return name_of(o) == name_of(item); }))
        out.push_back(item);
  } catch (const std::invalid_argument& error) {
    throw BadValue(error.what());
  }
  return out;
}

Take take_whole(std::optional<std::uint32_t>& target, Whole<std::uint32_t> range = {}) {
  return [&target, range](const std::string& text) { target = whole_number(text, range); };
}

Take take_seconds(std::optional<double>& target) {
  return [&target](const std::string& text) {
    target = scenes::parse_fraction(text);
    if (!target || !(*target > 0)) throw BadValue("'" + text + "' is not a positive number");
  };
}

void add_grid_options(Command& command, StabilityOptions& o) {
  const Option quick =
      command.add_flag("--quick", o.quick, "Half a minute at most: fewer values, three steps, shorter runs");
  command.add_flag("--full", o.full, "Every combination, not only the two planes drawn: many minutes")
      .excludes(quick);
  const auto scene_name = [](StabilityScene scene) { return to_string(scene); };
  command.add_option(
      "--scenes", "S1,S2,...",
      [&o, scene_name](const std::string& text) { o.scenes = chosen(text, all_scenes, scene_name); },
      "Of chains, nets, ropes, drapes, boxes, separated by commas [all]");
  std::string words;
  for (const StabilityMethod& method : scenes::all_stability_methods()) append_item(words, method.name, "|");
  command.add_option(
      "--methods", "M1,M2,...",
      [&o](const std::string& text) {
        o.methods =
            chosen(text, scenes::all_stability_methods(), [](const StabilityMethod& m) { return m.name; });
      },
      "Of " + words +
          ", separated by commas [all but auto; of what lands, auto, relax-new and direct-old alone]");
  add_list(command, "--ratios", o.ratios, scenes::parse_number<double>,
           "Mass of the last particle to that of each other [1,10,...,1e6]");
  add_list(command, "--speeds", o.speeds, scenes::parse_number<double>,
           "Speeds of what lands, in m/s [1,3,10,30,100]");
  add_list(command, "--links", o.links, scenes::parse_number<std::uint32_t>,
           "Lengths of chain [5,20,100,1000,10000]");
  add_list(command, "--sizes", o.sizes, scenes::parse_number<std::uint32_t>,
           "Particles along a net's side [4,8,16,32]");
  add_list(command, "--dt", o.dts, scenes::parse_fraction,
           "Steps in seconds [0.001,0.003,0.01,1/60,0.033,0.1]");
  command.add_option("--at-dt", "S", take_seconds(o.at_dt),
                     "Step of the maps over links and sizes, one of --dt [1/60, or else the longest]");
  command.add_option("--at-links", "N", take_whole(o.at_links),
                     "Links of the map over steps, one of --links [100, or else the longest]");
  command.add_option("--duration", "S", take_seconds(o.duration),
                     "Simulated time in seconds, rounded to whole steps [3, of what lands 1]");
  add_count(command, "--sweeps", o.report.sweeps, "Passes of relaxation over all rods a step [20]");
  add_seconds(command, "--budget", o.report.budget_s,
              "Most wall-clock time for a cell; above, it is too slow [2]");
}

void add_random_options(Command& command, StabilityOptions& o) {
  add_count(command, "--hangings", o.hangings,
            "Instead of maps, hang up so many random lines, nets, bridges, cranes and others", {.least = 1});
  command.add_option("--shots", "N", take_whole(o.shots, {.least = 1}),
                     "Instead of maps, fire so many random shots at walls, ropes, nets, figures and boxes");
  command.add_option("--shot", "N", take_whole(o.shot),
                     "Instead of maps, fire the shot of this number alone");
  add_count(command, "--seed", o.seed, "Seed of the first hanging, and of all shots [1]");
  add_count(command, "--threads", o.threads, "Threads that share shots; 0: as many as processors [0]");
}

}  // namespace

void add_stability_command(Command& plumb) {
  Command command = plumb.add_command(
      "stability",
      "Map where methods hold and break: end mass, size, speed, step; random hangings and shots");
  auto options = std::make_shared<StabilityOptions>();
  StabilityOptions& o = *options;
  add_grid_options(command, o);
  command.add_option("--out", "DIR", o.out,
                     "Write stability.csv, stability.html and pictures into this folder [out]");
  add_random_options(command, o);
  command.add_flag("--quiet", o.quiet, "No progress bar");
  command.set_footer(
      "A cell survives if its state stays finite, no island is frozen, no substep stays unsolved, no rod is "
      "ever stretched\nby more than 50 %, nothing is deeper in the ground than half its radius, and energy "
      "does not rise: by its range, or of\nwhat lands by a hundredth of it.\n\nExamples:\n"
      "  plumb stability\n  plumb stability --hangings 1000\n"
      "  plumb stability --shots 100000\n"
      "  plumb stability --shot 307\n"
      "  plumb stability --quick --methods relax-new,direct-mid\n"
      "  plumb stability --scenes ropes,drapes,boxes --speeds 100 --dt 1/60\n"
      "  plumb stability --full --budget 10 --out out-full\n"
      "  plumb stability --links 20 --ratios 1,1000 --dt 1/240,1/60 --methods direct-mid");
  command.set_action([options, command] {
    options->report.typed = command.typed();
    return stability(*options);
  });
}

}  // namespace plumb::tools
