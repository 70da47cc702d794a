// plumb frontier measures run time against error, with every method on the same scenes.
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <limits>
#include <memory>
#include <optional>

#include "cli/commands.hpp"
#include "cli/options.hpp"
#include "cli/progress.hpp"
#include "frontier/contest.hpp"
#include "frontier/peers.hpp"
#include "plot/gnuplot.hpp"
#include "plot/page.hpp"
#include "plumb/error.hpp"
#include "scenes/basics/files.hpp"
#include "scenes/basics/json.hpp"
#include "scenes/basics/lists.hpp"
#include "scenes/basics/numbers.hpp"
#include "scenes/runs/report.hpp"

namespace plumb::tools {
namespace {

using frontier::Point;
using frontier::Problem;
using scenes::append_item;
using scenes::plain_number;
using scenes::short_number;

struct FrontierOptions {
  std::vector<Problem> problems = frontier::all_problems();
  std::vector<std::string> families = frontier::all_families();
  frontier::Limits limits;
  double truth_s = 6;
  std::string peers;
  std::string out = "out";
  std::string typed;
  bool quiet = false;
};

/// A result has a scene and what was measured on it.
struct Result {
  Problem problem;
  std::vector<Point> points;
};

const double targets[] = {1e-1, 1e-2, 1e-3, 1e-4, 1e-5, 1e-6, 1e-7};

/// A method counts as faster if the other takes this many times as long. Less is noise.
constexpr double clearly = 1.1;

const char* color_of(const std::string& family) {
  static const std::pair<const char*, const char*> colors[] = {{"auto", "#000000"},
                                                               {"direct", "#d1495b"},
                                                               {"relax", "#1f5fa8"},
                                                               {"over-relaxed", "#66a3dd"},
                                                               {"jacobi", "#8c564b"},
                                                               {"springs", "#2a9d5c"},
                                                               {"implicit-springs", "#8fd19e"},
                                                               {"multipliers", "#e09f3e"},
                                                               {"featherstone", "#8e44ad"},
                                                               {"Bullet soft", "#a8a8a8"},
                                                               {"Bullet multibody", "#5f5f5f"},
                                                               {"MuJoCo", "#9c6b4a"},
                                                               {"Simbody", "#c08497"}};
  for (const auto& [name, color] : colors)
    if (family == name) return color;
  return "#888888";
}

const Point* cheapest(const std::vector<Point>& points, double error, const std::string& family) {
  const Point* best = nullptr;
  for (const Point& point : points) {
    if (!family.empty() && point.family != family) continue;
    if (point.position_error <= error && (!best || point.ms < best->ms)) best = &point;
  }
  return best;
}

std::vector<std::string> families_in(const std::vector<Point>& points) {
  std::vector<std::string> out;
  for (const Point& point : points)
    if (std::find(out.begin(), out.end(), point.family) == out.end()) out.push_back(point.family);
  return out;
}

/// Returns a row for each target that anything meets, with what each family takes for it.
Table target_table(const Result& result) {
  const std::vector<std::string> families = families_in(result.points);
  std::vector<std::string> header{"error at most"};
  for (const std::string& family : families) header.push_back(family + ", ms");
  header.insert(header.end(), {"cheapest", "auto / best of plumb", "auto picked"});
  Table table(header);
  for (const double target : targets) {
    const Point* best = cheapest(result.points, target, {});
    if (!best || target < result.problem.truth_error) continue;
    std::vector<std::string> row{short_number(target)};
    double fixed = std::numeric_limits<double>::infinity();
    for (const std::string& family : families) {
      const Point* point = cheapest(result.points, target, family);
      row.push_back(point ? plain_number(point->ms) : no_value);
      if (point && (family == "direct" || family == "relax" || family == "over-relaxed"))
        fixed = std::min(fixed, point->ms);
    }
    const Point* picked = cheapest(result.points, target, "auto");
    row.push_back(best->setting);
    row.push_back(picked && std::isfinite(fixed) ? plain_number(picked->ms / fixed) : no_value);
    row.push_back(picked ? picked->picked + ": " + picked->setting : no_value);
    table.add_row(row);
  }
  return table;
}

/// Returns the points of a family that none of its own dominates.
Series series_of(const Result& result, const std::string& family) {
  const auto own_families = frontier::all_families();
  const bool is_own = std::find(own_families.begin(), own_families.end(), family) != own_families.end();
  Series series{.name = family, .color = color_of(family), .dashed = !is_own};
  std::vector<const Point*> own;
  std::vector<std::pair<double, double>> list;
  for (const Point& point : result.points) {
    if (point.family != family) continue;
    own.push_back(&point);
    list.emplace_back(point.ms, point.position_error);
  }
  const std::vector<bool> front = frontier::find_front(list, result.problem.truth_error);
  for (std::size_t i = 0; i < own.size(); ++i)
    if (front[i])
      series.points.emplace_back(own[i]->ms, std::max(own[i]->position_error, result.problem.truth_error));
  std::sort(series.points.begin(), series.points.end());
  return series;
}

Chart chart_of(const Result& result) {
  Chart chart{.title = result.problem.name + ": run time against error",
              .x = "ms of stepping per simulated second",
              .y = "position error at " + short_number(result.problem.duration) + " s, of the diagonal",
              .series = {}};
  Series front{.name = "front", .color = "#ffd76a", .width = 9};
  for (const Point& point : result.points)
    if (point.on_front)
      front.points.emplace_back(point.ms, std::max(point.position_error, result.problem.truth_error));
  std::sort(front.points.begin(), front.points.end());
  chart.series.push_back(front);
  for (const std::string& family : families_in(result.points))
    chart.series.push_back(series_of(result, family));
  return chart;
}

/// Names the families on the front, from the fastest to the nearest, each as often as it comes again.
std::string places_of(const Result& result) {
  std::vector<const Point*> front;
  for (const Point& point : result.points)
    if (point.on_front) front.push_back(&point);
  std::sort(front.begin(), front.end(), [](const Point* a, const Point* b) { return a->ms < b->ms; });
  std::string out;
  const std::string* last = nullptr;
  for (const Point* point : front) {
    if (last && *last == point->family) continue;
    append_item(out, point->family);
    last = &point->family;
  }
  return out;
}

bool is_of_plumb(const std::string& family) {
  return family == "auto" || family == "direct" || family == "relax" || family == "over-relaxed";
}

/// Names the targets at which another family or library is clearly faster than plumb's own.
std::string lost_of(const Result& result) {
  std::string out;
  for (const double target : targets) {
    if (target < result.problem.truth_error) continue;
    const Point* own = nullptr;
    const Point* other = nullptr;
    for (const std::string& family : families_in(result.points)) {
      const Point* point = cheapest(result.points, target, family);
      const Point*& best = is_of_plumb(family) ? own : other;
      if (point && (!best || point->ms < best->ms)) best = point;
    }
    if (other && (!own || own->ms > clearly * other->ms))
      append_item(out, short_number(target) + " (" + other->setting +
                           (own ? ", " + plain_number(own->ms / other->ms) + " times as fast)" : ")"));
  }
  return out;
}

std::string truth_text(const Problem& problem) {
  return problem.truth_source + ", known to " + short_number(problem.truth_error, 2);
}

Table summary_table(const std::vector<Result>& results) {
  Table table({"scene", "rods", "truth", "points", "on the front, fastest first", "others faster at"});
  for (const Result& r : results) {
    const std::string lost = lost_of(r);
    table.add_row({r.problem.name, std::to_string(r.problem.scene.rods.size()), truth_text(r.problem),
                   std::to_string(r.points.size()), places_of(r), lost.empty() ? "none" : lost});
  }
  return table;
}

std::string csv_of(const std::vector<Result>& results) {
  std::string csv = std::string(frontier::csv_header);
  for (const Result& r : results)
    for (const Point& p : r.points) csv += frontier::csv_row(r.problem.name, p);
  return csv;
}

scenes::Json json_of(const std::vector<Result>& results) {
  scenes::Json list = scenes::Json::array();
  for (const Result& r : results) {
    scenes::Json points = scenes::Json::array();
    for (const Point& p : r.points)
      points.push_back({{"family", p.family},
                        {"setting", p.setting},
                        {"ms_per_s", p.ms},
                        {"median_ms_per_s", p.median_ms},
                        {"repetitions", p.repetitions},
                        {"position_error", p.position_error},
                        {"stretch_max", p.stretch},
                        {"energy_drift", p.energy_drift},
                        {"on_front", p.on_front},
                        {"picked", p.picked.empty() ? nullptr : scenes::Json(p.picked)}});
    list.push_back({{"scene", r.problem.name},
                    {"spec", r.problem.spec},
                    {"rods", r.problem.scene.rods.size()},
                    {"duration", r.problem.duration},
                    {"truth", {{"source", r.problem.truth_source}, {"error", r.problem.truth_error}}},
                    {"points", points}});
  }
  return list;
}

constexpr const char* frontier_text =
    "Every method on the same scenes, from rest, one thread. Error: RMS distance of all particles to the "
    "truth "
    "at the end, relative to the diagonal of the scene's first box; rods with mass are compared with the "
    "exact "
    "motion of such rods, which methods with masses at particles alone (relaxation, springs between "
    "particles) "
    "cannot reach. The winch's first rod is reeled in all the time, at a constant rate. What lands or is "
    "struck has no truth "
    "but a direct run in ever shorter substeps: it counts as known to the distance of the last two. Time: of "
    "stepping "
    "alone, the least of several repetitions, in turns. Settings, from "
    "coarse "
    "to fine, go as far as a fixed time for each allows; those that break, or whose rods stretch to twice "
    "their "
    "length, are left out. A line shows what of a family nothing else in it beats; the broad one is the "
    "front.";

void publish(const FrontierOptions& options, const std::vector<Result>& results) {
  const std::filesystem::path folder = options.out;
  scenes::Machine machine = scenes::describe_machine();
  machine.threads = 1;
  scenes::write_file(folder / "frontier.csv", csv_of(results));
  scenes::Json json{{"command", "plumb frontier" + options.typed},
                    {"machine", scenes::machine_json(machine)},
                    {"limits", {{"path_s", options.limits.path_s}, {"repeat_s", options.limits.contest_s}}}};
  json["scenes"] = json_of(results);
  scenes::write_file(folder / "frontier.json", scenes::format_json(json));
  Section section("frontier", "The frontier: run time against error", "plumb frontier" + options.typed,
                  machine);
  section.add_live();
  section.add_text(frontier_text);
  section.add_table(summary_table(results));
  for (const Result& r : results) {
    section.add_heading(r.problem.name);
    const std::string lost = lost_of(r);
    section.add_text(
        r.problem.spec + ", " + std::to_string(r.problem.scene.rods.size()) +
        " rods. Truth: " + truth_text(r.problem) + ". " +
        (lost.empty()
             ? "No other family is faster than direct, relaxation or auto at any of the errors below."
             : "Another family is faster than direct, relaxation and auto to an error of " + lost + "."));
    section.add_chart(folder, "frontier_" + r.problem.name, chart_of(r));
    section.add_table(target_table(r));
  }
  section.publish_alone(folder);
  section.publish(folder);
}

int run_frontier(FrontierOptions options) {
  require_gnuplot();
  make_folder(options.out);
  const auto peers =
      options.peers.empty() ? std::vector<frontier::PeerPoint>{} : frontier::read_points(options.peers);
  std::printf("%s\n\n", frontier_text);
  std::vector<Result> results;
  {
    Progress progress("measuring", options.quiet);
    for (Problem& problem : options.problems) {
      frontier::prepare(problem, options.truth_s);
      Result result{.problem = problem,
                    .points = frontier::compete(problem, options.families, options.limits)};
      frontier::add_peers(peers, result.problem, result.points);
      std::printf("%s: %s\n%s\n", problem.name.c_str(), truth_text(problem).c_str(),
                  target_table(result).to_text().c_str());
      std::fflush(stdout);
      results.push_back(std::move(result));
      progress.show(results.size(), options.problems.size());
    }
  }
  std::printf("%s", summary_table(results).to_text().c_str());
  publish(options, results);
  if (!options.quiet) std::printf("\nPage: %s/frontier.html\n", options.out.c_str());
  return fine;
}

std::vector<Problem> problems_named(const std::string& list) {
  try {
    return scenes::named(list, frontier::all_problems(), [](const Problem& p) { return p.name; });
  } catch (const std::invalid_argument& error) {
    throw BadValue(error.what());
  }
}

std::vector<std::string> families_named(const std::string& list) {
  try {
    return scenes::named(list, frontier::all_families(), [](const std::string& name) { return name; });
  } catch (const std::invalid_argument& error) {
    throw BadValue(error.what());
  }
}

}  // namespace

void add_frontier_command(Command& plumb) {
  Command command = plumb.add_command("frontier", "Measure run time against error, every method");
  auto options = std::make_shared<FrontierOptions>();
  FrontierOptions& o = *options;
  command.add_flag(
      "--quick",
      [&o] {
        o.problems = problems_named("N20_r1000,N1000_r10,rods5");
        o.limits = {.path_s = 0.05, .contest_s = 1.5};
      },
      "Three scenes, half a minute");
  command.add_option(
      "--scenes", "S1,S2,...", [&o](const std::string& text) { o.problems = problems_named(text); },
      "Some of the scenes, separated by commas [all]");
  command.add_option(
      "--methods", "M1,M2,...", [&o](const std::string& text) { o.families = families_named(text); },
      "Some of " + scenes::joined(frontier::all_families(), "|") + " [all]");
  add_seconds(command, "--path-seconds", o.limits.path_s,
              "Wall-clock time for settings from coarse to fine [0.1]");
  add_seconds(command, "--repeat-seconds", o.limits.contest_s,
              "Wall-clock time for a scene's repetitions [6]");
  command.add_option("--peers", "PEERS.csv", o.peers,
                     "Points of other libraries, as bench_peers writes them, into the same page");
  command.add_option("--out", "DIR", o.out,
                     "Write frontier.csv, frontier.json, frontier.html and charts here [out]");
  command.add_flag("--quiet", o.quiet, "No progress bar");
  std::string names;
  for (const Problem& problem : o.problems) append_item(names, problem.name);
  command.set_footer("Scenes: " + names +
                     "\n\nExamples:\n"
                     "  plumb frontier\n"
                     "  plumb frontier --quick --out out\n"
                     "  plumb frontier --scenes N20_r1000,rods5 --methods auto,direct,featherstone");
  command.set_action([options, command] {
    options->typed = command.typed();
    return run_frontier(*options);
  });
}

}  // namespace plumb::tools
