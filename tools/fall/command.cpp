// plumb fall lets ropes and nets fall on ground and on each other.
#include <cmath>
#include <cstdio>
#include <memory>

#include "cli/commands.hpp"
#include "cli/options.hpp"
#include "cli/progress.hpp"
#include "fall/measure.hpp"
#include "fall/pictures.hpp"
#include "plot/page.hpp"
#include "scenes/basics/numbers.hpp"
#include "scenes/runs/machine.hpp"
#include "scenes/spec.hpp"

namespace plumb::tools {
namespace {

using scenes::short_number;

struct FallOptions {
  bool quick = false, quiet = false;
  std::string out, typed;
};

struct Contest {
  std::string name;
  std::vector<std::string> scenes;  ///< of growing size; the first one is drawn
  std::vector<std::uint32_t> shown;
};

std::vector<Contest> contests(bool quick) {
  const auto rope = [](const char* links, const char* rest = "") {
    return std::string("rope:links=") + links + rest;
  };
  std::vector<Contest> out = {
      {"a level rope", {rope("100"), rope("1000")}, {}},
      {"a rope that coils", {rope("100", ",coil=0.3"), rope("1000", ",coil=0.3")}, {0, 20, 40, 90}},
      {"a rope let down in turns", {rope("200", ",coil=0.25,pitch=0.12,length=0.06")}, {0, 20, 40, 90}},
      {"a heap of ropes", {"heap", "heap:ropes=64"}, {0, 20, 40, 90}},
      {"a net on a box", {"drape:size=20", "drape:size=40"}, {0, 15, 30, 90}},
      {"a net on a sphere", {"drape:size=20,sphere=1", "drape:size=40,sphere=1"}, {0, 15, 30, 90}}};
  if (quick)
    for (Contest& each : out) each.scenes.resize(1);
  else
    out.front().scenes.push_back(rope("10000"));
  return out;
}

Settings settings_of(Method method) {
  Settings settings{.method = method, .threads = 1};
  if (method == Method::relax) {
    settings.substeps = 4;
    settings.stop.sweeps = 10;
  }
  return settings;
}

std::string milliseconds(double seconds) {
  return short_number(1e3 * seconds, 3);
}

std::vector<std::string> row_of(const std::string& scene, const Fall& fall, const FallResult& result) {
  const StepReport& total = result.total;
  return {scene,
          std::string(to_string(fall.settings.method)),
          milliseconds(result.mean_s),
          milliseconds(result.median_s),
          milliseconds(result.worst_s),
          short_number(1e9 * result.mean_s / static_cast<double>(result.rods), 3),
          short_number(result.stretch, 2),
          short_number(1e3 * result.depth, 2),
          short_number(1e3 * result.last_depth, 2),
          std::to_string(total.newton),
          std::to_string(total.block_sweeps),
          std::to_string(total.fallbacks),
          std::to_string(total.unsolved)};
}

constexpr const char* fall_text =
    "Ropes of capsules and nets fall on a plane, on a box, on a sphere and on each other, for 1.5 s at 60 "
    "frames a second, "
    "on one thread. Method auto solves what touches in few places and relaxes crowds; method relax takes 4 "
    "substeps of 10 sweeps. Times are of a frame, in ms, and of a rod and frame, in ns; strain is the "
    "largest at "
    "any frame's end; depth, in mm, is how far an end of a shape was in the ground, ever and at last.";

int fall(const FallOptions& options) {
  if (!options.out.empty()) make_folder(options.out);
  const std::vector<Contest> all = contests(options.quick);
  Table table({"scene", "method", "mean", "median", "worst", "a rod", "strain", "depth", "at last", "Newton",
               "sweeps", "fallbacks", "unsolved"});
  Table slopes({"scene", "method", "time grows as rods to the"});
  std::vector<std::pair<std::string, std::string>> pictures;
  std::uint64_t unsolved = 0, done = 0, count = 0;
  bool finite = true;
  for (const Contest& each : all) count += 2 * each.scenes.size();
  {
    Progress progress("falling", options.quiet);
    for (const Contest& each : all)
      for (const Method method : {Method::automatic, Method::relax}) {
        std::vector<FallResult> results;
        for (const std::string& scene : each.scenes) {
          const bool is_drawn = results.empty() && method == Method::automatic && !options.out.empty();
          const Fall run{.scene = scene,
                         .settings = settings_of(method),
                         .shown = is_drawn ? each.shown : std::vector<std::uint32_t>{}};
          results.push_back(run_fall(run));
          const FallResult& result = results.back();
          table.add_row(row_of(scene, run, result));
          unsolved += result.total.unsolved;
          finite = finite && result.finite;
          if (!result.shown.empty())
            pictures.emplace_back(each.name + ": plumb run " + scene,
                                  draw_fall(scenes::load_scene(scene), result.shown));
          progress.show(++done, count);
        }
        if (results.size() > 1)
          slopes.add_row({each.name, std::string(to_string(method)),
                          short_number(growth(results.front(), results.back()), 3)});
      }
  }
  std::printf("%s\n\n%s", fall_text, table.to_text().c_str());
  if (!options.quick) std::printf("\n%s", slopes.to_text().c_str());
  if (!options.out.empty()) {
    const World world(scenes::load_scene("drop"), settings_of(Method::automatic));
    Section section("fall", "Ropes and nets that fall", "plumb fall" + options.typed,
                    scenes::describe_machine(world.info()));
    section.add_text(fall_text);
    section.add_table(table);
    if (!options.quick) section.add_table(slopes);
    int number = 0;
    for (const auto& [title, svg] : pictures) {
      section.add_heading(title);
      section.add_svg(options.out, "fall_" + std::to_string(++number), svg);
    }
    section.publish(options.out);
    if (!options.quiet) std::printf("\nPage: %s/index.html\n", options.out.c_str());
  }
  if (!finite) throw CheckFailed("a state is not finite");
  if (unsolved > 0) throw CheckFailed(std::to_string(unsolved) + " substeps could not be solved");
  return fine;
}

}  // namespace

void add_fall_command(Command& plumb) {
  Command command =
      plumb.add_command("fall", "Let ropes and nets fall on ground and each other; time, strain and depth");
  auto options = std::make_shared<FallOptions>();
  FallOptions& o = *options;
  command.add_flag("--quick", o.quick, "The smallest scene of each kind");
  command.add_option("--out", "DIR", o.out, "Write a page with drawn instants into this folder");
  command.add_flag("--quiet", o.quiet, "No progress bar");
  command.set_footer("Examples:\n  plumb fall --quick\n  plumb fall --out out");
  command.set_action([options, command] {
    options->typed = command.typed();
    return fall(*options);
  });
}

}  // namespace plumb::tools
