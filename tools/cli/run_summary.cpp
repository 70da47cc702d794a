#include "cli/run_summary.hpp"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <cstdio>

#include "scenes/basics/lists.hpp"
#include "scenes/basics/numbers.hpp"
#include "scenes/basics/shapeless.hpp"
#include "scenes/basics/start_strain.hpp"
#include "scenes/runs/counters.hpp"
#include "scenes/runs/report.hpp"

namespace plumb::tools {
namespace {

using scenes::RunPlan;
using scenes::RunResult;
using scenes::short_number;

/// Rods that start off their length by less are what rounding in a file leaves.
constexpr double least_start_strain = 1e-4;

std::string percent(double share) {
  return short_number(100 * share, 4) + " %";
}

void print_line(const char* name, const std::string& text) {
  std::printf("%-9s %s\n", name, text.c_str());
}

void print_method(const RunPlan& plan, const RunResult& result) {
  const Settings& s = plan.settings;
  std::string text = "integrator " + std::string(to_string(integrator_of(s)));
  if (s.method == Method::springs)
    text += ", " + std::string(to_string(s.springs.model)) + ", stiffness " +
            short_number(s.springs.stiffness) + " N/m, damping ratio " +
            short_number(s.springs.damping_ratio);
  if (s.method == Method::multipliers)
    text += ", stabilization " + std::string(to_string(s.multipliers.stabilization));
  print_line("method", std::string(to_string(s.method)) + ", " + text + ", mass " +
                           std::string(to_string(mass_model_of(s))) +
                           (s.accuracy ? ", accuracy " + short_number(*s.accuracy) : "") +
                           (s.stop.tolerance ? ", nets' tolerance " + short_number(*s.stop.tolerance) : ""));
  print_line("steps", plural(result.frames, "frame") + " of " + short_number(plan.dt) + " s, " +
                          plural(s.substeps, "substep") + " each");
}

/// Prints every counter of the run that counted something.
void print_counts(const StepReport& total) {
  std::string list;
  for (const scenes::Counter& counter : scenes::counters())
    if (is_counted(counter, total))
      scenes::append_item(list, std::string(counter.meaning) + ": " + text_of(counter, total), "; ");
  print_line("counts", list);
}

void print_direct(const RunPlan& plan, const RunResult& result) {
  const Settings& s = plan.settings;
  const WorldInfo& info = result.info;
  const bool relaxes_crowds = info.relaxed_rods == 0 && result.total.rod_projections > 0;
  print_line(
      "direct",
      (info.direct_rods > 0 ? plural(info.direct_rods, "rod") + " " : "") + "solved all at once, " +
          (relaxes_crowds ? "relaxed where they touch, " : "") + "gradient " +
          std::string(to_string(info.direct_gradient)) + (info.changes_gradient ? " (mid while calm)" : "") +
          (info.direct_time_order == 2 ? std::string()
                                       : ", time order " + std::to_string(info.direct_time_order)) +
          ", mass " + std::string(to_string(mass_model_of(s))) + ", " + std::string(to_string(s.precision)) +
          (s.accuracy ? ", accuracy " + short_number(*s.accuracy) : "") +
          (s.stop.tolerance ? ", nets' tolerance " + short_number(*s.stop.tolerance) : ""));
  print_line("steps", plural(result.frames, "frame") + " of " + short_number(plan.dt) + " s" +
                          (s.accuracy ? "" : ", " + plural(s.substeps, "substep") + " each"));
}

void print_relaxation(const RunPlan& plan, const RunResult& result) {
  const Settings& s = plan.settings;
  Settings relaxed = s;
  relaxed.method = Method::relax;
  std::string stop = "at most " + plural(s.stop.sweeps, "sweep");
  if (s.stop.tolerance) stop += ", tolerance " + short_number(*s.stop.tolerance);
  if (s.stop.budget_us) stop += ", " + short_number(*s.stop.budget_us) + " µs a frame";
  if (result.total.block_sweeps > 0)
    stop += " (stopped by " + std::string(to_string(result.total.stopped_by)) + ")";
  const std::uint64_t rods = result.info.relaxed_rods;
  print_line("relax", (rods > 0 ? plural(rods, "rod") + ", " : "") + std::string(to_string(s.order)) +
                          ", gradient " + std::string(to_string(gradient_of(relaxed))) + ", weights " +
                          std::string(to_string(s.weights)) + ", omega " + short_number(s.omega) + ", " +
                          std::string(to_string(s.precision)));
  print_line("steps", plural(result.frames, "frame") + " of " + short_number(plan.dt) + " s, " +
                          plural(s.substeps, "substep") + " each, " + stop);
}

/// Returns by what to divide for a mean: a run may be stopped before its first frame.
double frames_of(const RunResult& result) {
  return static_cast<double>(std::max<std::uint64_t>(result.frames, 1));
}

void print_stages(const RunResult& result) {
  std::string list;
  for (const scenes::StageTime& stage : result.stages)
    scenes::append_item(
        list, std::string(stage.name) + " " + short_number(1e6 * stage.s / frames_of(result)) + " µs", ", ");
  if (!list.empty()) print_line("stages", list + " a frame");
}

/// Prints what a budget of time did.
void print_budget(const RunPlan& plan, const RunResult& result) {
  if (!plan.step_budget_us) return;
  const double frames = frames_of(result);
  std::string text = short_number(*plan.step_budget_us) + " µs a step; " +
                     plural(result.late_frames, "frame") + " took longer, the longest " +
                     short_number(result.longest_step_us) + " µs";
  if (!plan.settings.accuracy)
    text += "; " + short_number(static_cast<double>(result.total.substeps) / frames) + " of " +
            plural(plan.settings.substeps, "substep") + " in the mean, " +
            short_number(result.total.asked_us / frames) + " µs for all";
  print_line("budget", text);
}

void print_errors(const RunResult& result) {
  if (result.info.rods > 0)
    print_line("stretch", "RMS " + percent(result.stretch.rms) + ", max " + percent(result.stretch.max) +
                              " (rod " + std::to_string(result.stretch.max_rod) + ")");
  const scenes::EnergyDrift& energy = result.energy;
  print_line("energy", short_number(energy.initial) + " J at first, " + short_number(energy.final) +
                           " J at last, change at most " +
                           (energy.range > 0 ? percent(energy.drift_max / energy.range) + " of the range"
                                             : short_number(energy.drift_max) + " J"));
  for (const scenes::PositionError& error : result.position_error) {
    print_line("error", short_number(error.rms_m) + " m at " + short_number(error.t) + " s, " +
                            percent(error.relative) + " of the scene's diagonal");
  }
}

/// Prints what was wrong with the scene at first.
void print_start(const Scene& scene, const WorldInfo& info) {
  if (const std::string strain = start_text(scene); !strain.empty() || info.projected_position > 0)
    print_line("start", (strain.empty() ? "rods did not start at their lengths" : strain) +
                            (info.projected_position > 0 ? "; particles moved by at most " +
                                                               short_number(info.projected_position) + " m"
                                                         : "; steps move particles for that"));
  if (info.unprojected_islands > 0) {
    print_line("start", "in " + plural(info.unprojected_islands, "island") +
                            " rods do not fit together, and share what they lack");
  }
  if (info.projected_velocity > 0) {
    print_line("velocity", "initial velocities pulled on rods; changed by at most " +
                               short_number(info.projected_velocity) + " m/s");
  }
}

/// Names the first problems of the last frame, and the number of the others.
void print_problems(const std::vector<Problem>& problems) {
  constexpr std::size_t most_named = 4;
  if (problems.empty()) return;
  std::string text;
  for (std::size_t i = 0; i < std::min(problems.size(), most_named); ++i) {
    const Problem& problem = problems[i];
    std::string item =
        std::string(to_string(problem.kind)) + " at particle " + std::to_string(problem.particle);
    if (problem.kind == Problem::Kind::stretched)
      item = "rod " + std::to_string(problem.rod) + " stretched by " + short_number(100 * problem.strain, 3) +
             " %";
    text += (text.empty() ? "" : "; ") + item;
  }
  if (problems.size() > most_named) text += "; and " + std::to_string(problems.size() - most_named) + " more";
  print_line("problems", text + " (last frame)");
}

}  // namespace

std::string start_text(const Scene& scene) {
  const auto [rod, strain] = scenes::start_strain(scene);
  if (std::abs(strain) < least_start_strain) return "";
  return "rods did not start at their lengths, rod " + std::to_string(rod) + " by " +
         short_number(100 * strain, 3) + " %";
}

std::string shapeless_text(const Scene& scene) {
  const std::uint32_t count = scenes::has_ground(scene) ? scenes::count_shapeless(scene) : 0;
  if (count == 0) return "";
  return plural(count, "movable particle") + (count == 1 ? " has" : " have") +
         " no shape (capsules, hulls), and will pass through the ground";
}

std::string plural(std::uint64_t n, const char* noun) {
  return std::to_string(n) + " " + noun + (n == 1 ? "" : "s");
}

void print_run_summary(const std::string& name, const Scene& scene, const RunPlan& plan,
                       const RunResult& result, const scenes::Machine& machine) {
  const Settings& s = plan.settings;
  const WorldInfo& info = result.info;
  print_line("scene", name + ": " + plural(info.particles, "particle") + ", " + plural(info.rods, "rod") +
                          ", " + plural(info.islands, "island"));
  const bool family =
      s.method == Method::automatic || s.method == Method::relax || s.method == Method::direct;
  const bool solves_joints = info.linkages > 0 && s.method != Method::relax;
  const bool solves_no_rods = info.relaxed_rods == 0 && result.total.direct_substeps > 0;
  const bool solves = info.direct_rods > 0 || solves_joints || solves_no_rods;
  const bool sweeps = info.relaxed_rods > 0 || (!solves && info.particles > 0);
  const bool relaxes = family && !solves_joints && sweeps;
  if (!family) print_method(plan, result);
  if (solves) print_direct(plan, result);
  if (relaxes) print_relaxation(plan, result);
  print_budget(plan, result);
  if (const std::string shapeless = shapeless_text(scene); !shapeless.empty())
    print_line("shapes", shapeless);
  print_counts(result.total);
  print_errors(result);
  print_problems(result.problems);
  print_start(scene, info);
  std::string time = short_number(1e3 * result.wall_s, 4) + " ms, " +
                     short_number(1e6 * result.wall_s / frames_of(result), 4) + " µs a frame";
  if (info.rods > 0) time += ", " + short_number(result.ns_per_rod_frame(), 4) + " ns per rod and frame";
  print_line("time", time);
  print_stages(result);
  print_line("machine", machine.cpu + ", " + machine.isa + ", " + plural(machine.threads, "thread"));
  print_line("state", scenes::hash_text(result.state_hash));
}

}  // namespace plumb::tools
