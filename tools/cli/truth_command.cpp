// plumb truth finds a solution accurate enough to measure others by.
#include <algorithm>
#include <chrono>
#include <cstdio>
#include <memory>
#include <optional>

#include "cli/commands.hpp"
#include "cli/options.hpp"
#include "cli/progress.hpp"
#include "plumb/error.hpp"
#include "scenes/basics/files.hpp"
#include "scenes/basics/numbers.hpp"
#include "scenes/files/trajectory.hpp"
#include "scenes/spec.hpp"
#include "truth/truth.hpp"

namespace plumb::tools {
namespace {

using scenes::short_number;

struct TruthOptions {
  std::string scene;
  truth::Plan plan;
  std::string out, tensions;
  bool quiet = false;
};

std::string accuracy_text(const truth::Accuracy& accuracy) {
  return "positions " + short_number(accuracy.position, 2) + " of the diagonal, velocities " +
         short_number(accuracy.velocity, 2) + " of the speed";
}

void print_summary(const TruthOptions& options, const Scene& scene, const truth::Truth& result,
                   double wall_s) {
  const auto line = [](const char* name, const std::string& text) {
    std::printf("%-9s %s\n", name, text.c_str());
  };
  line("scene", options.scene + ": " + std::to_string(scene.particles.size()) + " particles, " +
                    std::to_string(scene.rods.size()) + " rods; mass " +
                    std::string(to_string(options.plan.mass)));
  line("relative", "to its diagonal, " + short_number(result.diagonal) + " m, and its speed, " +
                       short_number(result.speed) + " m/s");
  for (const truth::Accuracy& accuracy : result.accuracy) {
    line("accuracy", accuracy_text(accuracy) + " at " + short_number(accuracy.t) + " s");
  }
  const bool damped =
      std::any_of(scene.rods.begin(), scene.rods.end(), [](const Rod& rod) { return rod.law.damping > 0; });
  if (scene.drag == 0 && !damped && options.plan.rates.empty()) {
    line("energy", "changes by at most " + short_number(result.energy_drift, 2) + " of its range");
  }
  if (!options.tensions.empty())
    line("tension", "two solutions lie " + short_number(result.tension, 2) + " of the largest apart");
  if (result.velocity_change > 1e-15 * result.speed) {  // A change beyond rounding is reported.
    line("velocity", "initial velocities pulled on rods; changed by at most " +
                         short_number(result.velocity_change) + " m/s");
  }
  if (result.rows > 0) {
    line("loops", std::to_string(result.rows) + " equations, " + std::to_string(result.redundant) +
                      " of them implied by the others");
  }
  line("time",
       short_number(wall_s, 3) + " s, " + std::to_string(result.steps) + " steps in the better solution");
}

int truth_of(const TruthOptions& options) {
  const Scene scene = scenes::load_scene(options.scene);
  require_different_files({{"--out", options.out}, {"--tensions", options.tensions}});
  scenes::OutputFile out(options.out);
  std::optional<scenes::OutputFile> tensions;
  if (!options.tensions.empty()) tensions.emplace(options.tensions);
  const auto start = std::chrono::steady_clock::now();
  truth::Truth result;
  try {
    Progress progress("solving", options.quiet);
    truth::Plan plan = options.plan;
    if (!tensions) plan.mean_over = 0;
    std::sort(plan.save_at.begin(), plan.save_at.end());
    plan.save_at.erase(std::unique(plan.save_at.begin(), plan.save_at.end()), plan.save_at.end());
    plan.progress = [&](double share) {
      constexpr double parts = 1e6;
      progress.show(static_cast<std::uint64_t>(share * parts), static_cast<std::uint64_t>(parts));
    };
    result = truth::solve(scene, plan);
  } catch (const truth::Unreachable& error) {
    throw CheckFailed(std::string(error.what()) + "; nothing was written");
  }
  const double wall_s = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
  out.write(scenes::format_trajectory(result.frames));
  out.commit();
  if (tensions) {
    std::string rows(scenes::tensions_header);
    for (const Frame& frame : result.frames) scenes::append_tensions(rows, frame);
    tensions->write(rows);
    tensions->commit();
  }
  if (options.quiet) return fine;
  std::fprintf(stderr, "plumb: accurate to %s\n", accuracy_text(result.reached).c_str());
  print_summary(options, scene, result, wall_s);
  return fine;
}

constexpr const char* about =
    "Solves the equations of motion by Taylor series in time, in long double, with every rigid rod "
    "exactly\n"
    "at its length. It does so twice, at order 20 and at order 26, with different steps. How far the two\n"
    "lie apart is the accuracy stated: positions relative to the diagonal of the scene's box, velocities\n"
    "relative to its speed. That is the greatest of sqrt(gravity * diagonal), the speed of the fastest\n"
    "particle at the start, and what all mass gets from the energy of elastic rods then. The file is\n"
    "written only if both are within the tolerance at every time saved; otherwise the exit status is 1 "
    "and\n"
    "the message says until when they were. Nothing here is shared with what `plumb run` does.\n\n"
    "Rigid rods must start at their length, to 1e-10; velocities that pull on them are projected, as in a\n"
    "run. Elastic rods may be damped; cables and rods that may break are refused, as they are not smooth.\n"
    "Trees of rods have no limit; rods that close loops may be 1024, a third of that if they have mass.\n\n"
    "Examples:\n"
    "  plumb truth chain:links=20,end_mass=10 --save-at 0.1,0.5,1 --out truth.csv\n"
    "  plumb run chain:links=20,end_mass=10 --substeps 8 --truth truth.csv\n"
    "  plumb truth chain --save-at 0.5,1 --out truth.csv --tensions pulls.csv\n"
    "  plumb run chain --truth truth.csv --truth-tensions pulls.csv --report r.json\n"
    "  plumb truth winch --winch 0:-0.5 --save-at 1 --out winch.csv\n"
    "  plumb truth rods.json --mass lumped --save-at 1 --tolerance 1e-12 --out lumped.csv\n\n";

}  // namespace

void add_truth_command(Command& plumb) {
  Command command = plumb.add_command("truth", "Solve a scene so accurately that others can be measured");
  auto options = std::make_shared<TruthOptions>();
  TruthOptions& o = *options;
  o.plan.mean_over = 1.0 / 60;
  add_scene(command, o.scene);
  add_save_at(command, o.plan.save_at, "Times to save, in seconds, in any order").required();
  command.add_option("--out", "T.csv", o.out, "Write t,particle,x,y,z,vx,vy,vz to this file").required();
  command.add_option("--tensions", "TENSIONS.csv", o.tensions,
                     "Write t,rod,tension to this file: pulls of rods in N, averaged over --mean");
  add_seconds(command, "--mean", o.plan.mean_over,
              "Time before each one saved that tensions are averaged over [1/60]");
  add_winches(command, o.plan.rates);
  add_choice(command, "--mass", o.plan.mass, {MassModel::lumped, MassModel::consistent},
             "How a rod's own mass acts: as points at its ends, or exactly; the same if rods have none");
  add_positive(command, "--tolerance", o.plan.tolerance,
               "Refuse to write unless accurate to this, from 1e-15 [1e-9]");
  command.add_flag("--quiet", o.quiet, "Print nothing but errors");
  command.set_footer([&o] { return std::string(about) + generators_help(o.scene); });
  command.set_action([options] { return truth_of(*options); });
}

}  // namespace plumb::tools
