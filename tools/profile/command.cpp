// plumb profile measures bytes and cache misses of a rod's projection, by layout, shape, size and order of a
// sweep.
#include <algorithm>
#include <cstdio>
#include <memory>

#include "cli/commands.hpp"
#include "cli/options.hpp"
#include "cli/progress.hpp"
#include "plot/gnuplot.hpp"
#include "plot/page.hpp"
#include "plumb/error.hpp"
#include "profile/output.hpp"
#include "scenes/basics/files.hpp"
#include "scenes/basics/json.hpp"
#include "scenes/runs/report.hpp"

namespace plumb::tools {
namespace {

struct ProfileOptions {
  bool quick = false;
  std::optional<Way> way;
  std::optional<unsigned> last_level;
  Precision precision = Precision::single;
  std::vector<SweepOrder> orders = {SweepOrder::gauss_seidel, SweepOrder::jacobi};
  std::string out = "out";
  bool quiet = false;
  std::string typed;  ///< Options that the page repeats, as the user typed them.
};

/// A core has the second level to itself, so simulations end there. A scene outside a third level has
/// millions of rods, and setting it up under cachegrind takes minutes for every row.
constexpr unsigned last_level_simulated = 2;
constexpr unsigned last_level_counted = 9;

/// Returns the instruction set that can be measured: valgrind knows no AVX-512.
Isa isa_for(Way way) {
  return way == Way::cachegrind ? std::min(best_isa(), Isa::avx2) : best_isa();
}

std::string units_text(const Profile& profile) {
  return "Method relax, gradient new, " + std::string(to_string(profile.precision)) + ", " +
         std::string(to_string(profile.isa)) +
         ": what one sweep does, per projection of a rod. bytes: read and written by a projection before any "
         "cache (layouts/README.md), without the corrections that Jacobi keeps apart. fits: state and rods "
         "take half of that cache, or several times the last "
         "one; equal islands are worked on group by group, whatever they take together. LL bytes: misses "
         "times "
         "the line. ns: measured without simulation, median of five.";
}
constexpr const char* direct_text =
    "Method direct on equal chains in lanes, per rod and Newton step, predicting and moving the particles "
    "included; bytes: of the Newton step alone.";

void publish(const ProfileOptions& options, const Profile& profile) {
  const std::filesystem::path folder = options.out;
  scenes::Machine machine = scenes::describe_machine();
  machine.isa = to_string(profile.isa);
  machine.threads = 1;
  scenes::Json json{{"machine", scenes::machine_json(machine)}};
  json.update(profile_json(profile));
  scenes::write_file(folder / "profile.json", scenes::format_json(json));
  scenes::write_file(folder / "profile.csv", profile_csv(profile));

  Section section("profile", "Cache behaviour: bytes and misses of a projection",
                  "plumb profile" + options.typed, machine);
  section.add_text(way_text(profile));
  section.add_text(units_text(profile));
  for (const SweepOrder order : options.orders)
    for (const MissKind kind : {MissKind::l1d_read, MissKind::ll}) {
      const std::string svg = draw_misses(profile, kind, order);
      if (svg.empty()) continue;
      const std::string name = kind == MissKind::l1d_read ? "profile_l1d" : "profile_ll";
      section.add_svg(folder, order == SweepOrder::jacobi ? name + "_jacobi" : name, svg);
    }
  section.add_table(relax_table(profile));
  section.add_heading("Method direct");
  section.add_text(direct_text);
  section.add_table(direct_table(profile));
  section.publish_alone(folder);
  section.publish(folder);
}

int profile(const ProfileOptions& options) {
  require_gnuplot();
  make_folder(options.out);
  const Means means = find_means();
  Profile profile;
  profile.way = choose_way(options.way, means);
  profile.precision = options.precision;
  profile.isa = isa_for(profile.way);
  profile.caches = pick_caches(
      read_caches(),
      options.last_level.value_or(profile.way == Way::counters ? last_level_counted : last_level_simulated));
  profile.simulated = {profile.caches.first, profile.caches.last, profile.caches.assumed};
  if (profile.way == Way::cachegrind) {
    profile.simulated.first = nearest_simulated(profile.caches.first);
    profile.simulated.last = nearest_simulated(profile.caches.last);
    if (!means.refusals.empty() && !options.way)
      profile.remark = "The processor's counters could not be read: " + means.refusals + ".";
  } else if (profile.way == Way::none) {
    profile.remark = advice(means);
  } else if (!means.refusals.empty()) {
    profile.remark = "Not there: " + means.refusals + ".";
  }
  const std::vector<ProfileCase> cases = list_cases({.caches = profile.caches,
                                                     .precision = profile.precision,
                                                     .isa = profile.isa,
                                                     .quick = options.quick,
                                                     .orders = options.orders});
  {
    Progress progress("measuring", options.quiet);
    profile.rows = measure_cases(cases, profile.way, means, profile.simulated,
                                 [&](std::size_t done) { progress.show(done, cases.size()); });
  }
  std::printf("%s\n\n%s\n\n%s\n%s\n\n%s", way_text(profile).c_str(), units_text(profile).c_str(),
              relax_table(profile).to_text().c_str(), direct_text, direct_table(profile).to_text().c_str());
  publish(options, profile);
  if (!options.quiet) std::printf("\nPage: %s/profile.html\n", options.out.c_str());
  return fine;
}

int work(const WorkPlan& plan) {
  std::fputs(to_json_line(do_work(plan)).c_str(), stdout);
  return fine;
}

/// Adds the command that is run under cachegrind.
void add_worker(Command& profile_command) {
  Command command = profile_command.add_command(
      "worker", "Step one scene and print what was done, in JSON: what profile runs under cachegrind");
  auto plan = std::make_shared<WorkPlan>();
  add_scene(command, plan->scene);
  add_layout_options(command, plan->settings);
  add_solver_options(command, plan->settings);
  add_count(command, "--frames", plan->frames, "Steps [1]");
  add_seconds(command, "--dt", plan->dt, "Length of a step in seconds [1/60]");
  command.set_footer(
      "Example:\n  valgrind --tool=cachegrind --cache-sim=yes plumb profile worker chain:links=1000 "
      "--method relax --isa avx2 --sweeps 16\n\n" +
      methods_help());
  command.set_action([plan] { return work(*plan); });
}

}  // namespace

void add_profile_command(Command& plumb) {
  Command command =
      plumb.add_command("profile", "Measure bytes and cache misses of a projection, by layout and shape");
  auto options = std::make_shared<ProfileOptions>();
  ProfileOptions& o = *options;
  command.add_flag("--quick", o.quick, "About half a minute: fewer and smaller scenes");
  add_words(
      command, "--way", {"auto", "counters", "cachegrind"},
      [&o](const std::string& word) {
        o.way.reset();
        if (word != "auto") o.way = word == "counters" ? Way::counters : Way::cachegrind;
      },
      "The processor's counters, or caches simulated by valgrind's cachegrind; auto: the first of them that "
      "is there [auto]");
  add_words(
      command, "--last-level", {"2", "3"},
      [&o](const std::string& word) { o.last_level = word == "2" ? 2 : 3; },
      "The last cache to look at; 3 with cachegrind takes long [2 with cachegrind, else the last]");
  add_choice(command, "--precision", o.precision, {Precision::single, Precision::double_}, "Arithmetic");
  add_choice_or_both(command, "--order", o.orders, "Order of relaxation's sweeps");
  command.add_option("--out", "DIR", o.out,
                     "Write a page with pictures, JSON and CSV into this folder [out]");
  command.add_flag("--quiet", o.quiet, "No progress bar");
  command.set_footer(
      "Scenes are made to fit the caches of this machine. Without counters and without valgrind (package "
      "valgrind) cache\nmisses are shown as not available; bytes and times are there all the same.\n\n"
      "Examples:\n  plumb profile\n  plumb profile --quick --way cachegrind\n"
      "  plumb profile --precision double --out out-double");
  add_worker(command);
  command.set_action([options, command] {
    options->typed = command.typed();
    return profile(*options);
  });
}

}  // namespace plumb::tools
