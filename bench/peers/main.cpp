// bench_peers measures run time against error of other libraries, on the scenes of plumb frontier.
#include <algorithm>
#include <cstdio>
#include <optional>
#include <stdexcept>
#include <string>
#include <vector>

#include "frontier/peers.hpp"
#include "frontier/problem.hpp"
#include "measure.hpp"
#include "plot/table.hpp"
#include "scenes/basics/lists.hpp"
#include "scenes/basics/numbers.hpp"
#include "scenes/runs/machine.hpp"
#include "scenes/spec.hpp"
#include "support/flags.hpp"
#include "support/output.hpp"
#include "support/run_main.hpp"

namespace plumb::bench {
namespace {

using frontier::Point;
using frontier::Problem;

constexpr const char* usage =
    "usage: bench_peers [--scenes S1,S2,...] [--peers L1,L2,...] [--path-seconds S] [--repeat-seconds S]\n"
    "                   [--out FILE]\n"
    "\n"
    "Run time against error of other libraries, one thread, double precision, on scenes of plumb frontier:\n"
    "point masses on massless rods that hang in chains and trees. Each goes through its settings from "
    "coarse\n"
    "to fine; those that break are left out. Prints the cheapest setting for every error.\n"
    "\n"
    "  --scenes S1,S2,...   some of the scenes below [all]\n"
    "  --peers L1,L2,...    some of the libraries below [all]\n"
    "  --path-seconds S     wall-clock time for settings from coarse to fine [1]\n"
    "  --repeat-seconds S   wall-clock time for the repetitions of a library on a scene [1]\n"
    "  --out FILE           all points, as plumb frontier --peers reads them\n"
    "\n"
    "First every library must come near the truth on %s; one that does not is left out, and the exit\n"
    "status is 1.\n"
    "\n"
    "Scenes: %s\n"
    "Libraries: %s\n";

/// Models are checked on this problem, which moves quickly and is far from chaos.
constexpr const char* checked_on = "N5_r10";
/// A path of the check takes at most this long (s), which lets every family come as near as it must.
constexpr double check_s = 0.3;

const double targets[] = {1e-1, 1e-2, 1e-3, 1e-4, 1e-5, 1e-6, 1e-7};

std::vector<Problem> known_problems() {
  std::vector<Problem> out;
  for (Problem& problem : frontier::all_problems())
    if (has_links(scenes::load_scene(problem.spec))) out.push_back(std::move(problem));
  return out;
}

template <class Item>
std::string names_of(const std::vector<Item>& items) {
  std::string out;
  for (const Item& item : items) scenes::append_item(out, item.name);
  return out;
}

/// Finds named items as scenes::named() does, in an option's value.
template <class Item>
std::vector<Item> named(const std::string& option, std::string_view list, const std::vector<Item>& all) {
  try {
    return scenes::named(list, all, [](const Item& item) -> const std::string& { return item.name; });
  } catch (const std::invalid_argument& error) {
    throw std::invalid_argument(option + ": " + error.what());
  }
}

double take_seconds(Flags& flags, const std::string& name, double otherwise) {
  const auto text = flags.take_value(name);
  if (!text) return otherwise;
  const auto seconds = scenes::parse_fraction(*text);
  if (!seconds || !(*seconds > 0))
    throw std::invalid_argument(name + " must be a positive number of seconds");
  return *seconds;
}

double nearest(const PeerResult& result) {
  double least = std::numeric_limits<double>::infinity();
  for (const Point& point : result.points) least = std::min(least, point.position_error);
  return least;
}

/// Checks that what is built of a scene in another library moves as the scene does. Leaves the families whose
/// models do.
bool check(std::vector<PeerFamily>& families, const PeerLimits& limits) {
  Problem problem;
  for (const Problem& known : frontier::all_problems())
    if (known.name == checked_on) problem = known;
  frontier::prepare(problem, 1);
  bool good = true;
  std::erase_if(families, [&](const PeerFamily& family) {
    const double error =
        nearest(measure(problem, family, {.path_s = std::min(check_s, limits.path_s), .repeat_s = 0}));
    const bool reached = error <= family.must_reach;
    std::fprintf(
        stderr, "bench_peers: %s comes within %s of the truth on %s%s\n", family.name.c_str(),
        scenes::short_number(error, 2).c_str(), checked_on,
        reached ? ""
                : (", not within " + scenes::short_number(family.must_reach, 2) + " as it should: left out")
                      .c_str());
    good = good && reached;
    return !reached;
  });
  return good;
}

tools::Table target_table(const std::vector<PeerFamily>& families, const std::vector<Point>& points) {
  std::vector<std::string> header{"error at most"};
  for (const PeerFamily& family : families) header.push_back(family.name + ", ms");
  header.push_back("cheapest");
  tools::Table table(header);
  for (const double target : targets) {
    std::vector<std::string> row{scenes::short_number(target)};
    const Point* cheapest = nullptr;
    for (const PeerFamily& family : families) {
      const Point* best = nullptr;
      for (const Point& point : points)
        if (point.family == family.name && point.position_error <= target && (!best || point.ms < best->ms))
          best = &point;
      row.push_back(best ? scenes::plain_number(best->ms) : "-");
      if (best && (!cheapest || best->ms < cheapest->ms)) cheapest = best;
    }
    if (!cheapest) break;
    row.push_back(cheapest->setting);
    table.add_row(row);
  }
  return table;
}

int run(int argc, char** argv) {
  std::vector<Problem> problems = known_problems();
  std::vector<PeerFamily> families = all_peers();
  Flags flags(argc, argv);
  if (flags.take("--help") || flags.take("-h")) {
    std::printf(usage, checked_on, names_of(problems).c_str(), names_of(families).c_str());
    return 0;
  }
  if (const auto list = flags.take_value("--scenes")) problems = named("--scenes", *list, problems);
  if (const auto list = flags.take_value("--peers")) families = named("--peers", *list, families);
  PeerLimits limits;
  limits.path_s = take_seconds(flags, "--path-seconds", limits.path_s);
  limits.repeat_s = take_seconds(flags, "--repeat-seconds", limits.repeat_s);
  auto out = open_output(flags.take_value("--out").value_or(""));
  if (flags.rest().size() > 1)
    throw std::invalid_argument("unknown: " + flags.rest()[1] + "; see bench_peers --help");

  const bool good = check(families, limits);
  std::string csv(frontier::csv_header);
  std::printf("%s; one thread. ms of stepping per simulated second, the cheapest setting for every error.\n",
              scenes::describe_machine().cpu.c_str());
  for (Problem& problem : problems) {
    frontier::prepare(problem, 1);
    std::vector<Point> points;
    std::string failures;
    for (const PeerFamily& family : families) {
      const PeerResult result = measure(problem, family, limits);
      points.insert(points.end(), result.points.begin(), result.points.end());
      if (result.failed == 0) continue;
      std::string text = family.name + " " + std::to_string(result.failed);
      if (!result.reason.empty()) text += " (" + result.reason + ")";
      scenes::append_item(failures, text);
    }
    frontier::mark_front(points, problem.truth_error);
    for (const Point& point : points) csv += frontier::csv_row(problem.name, point);
    std::printf("\n%s\n%s", problem.name.c_str(), target_table(families, points).to_text().c_str());
    if (!failures.empty()) std::printf("Settings that broke and are left out: %s\n", failures.c_str());
    std::fflush(stdout);
  }
  finish_output(out, csv);
  return good ? 0 : 1;
}

}  // namespace
}  // namespace plumb::bench

int main(int argc, char** argv) {
  return plumb::bench::run_main("bench_peers", plumb::bench::run, argc, argv);
}
