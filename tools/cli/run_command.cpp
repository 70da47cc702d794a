// plumb run: simulate a scene, say how fast and how wrong.
#include <cstdio>
#include <filesystem>
#include <memory>
#include <optional>

#include "cli/commands.hpp"
#include "cli/options.hpp"
#include "cli/progress.hpp"
#include "export/gltf.hpp"
#include "export/vtk.hpp"
#include "plumb/error.hpp"
#include "scenes/basics/files.hpp"
#include "scenes/basics/numbers.hpp"
#include "scenes/files/trajectory.hpp"
#include "scenes/runs/report.hpp"
#include "scenes/spec.hpp"

namespace plumb::tools {
namespace {

using scenes::short_number;

struct RunOptions {
  std::string scene;
  scenes::RunPlan plan;
  std::vector<double> save_at;
  std::string trajectory;
  std::string truth;
  std::string report;
  std::string vtk;   ///< folder
  std::string gltf;  ///< file
  bool quiet = false;
};

std::string percent(double share) {
  return short_number(100 * share, 4) + " %";
}

std::string plural(std::uint64_t n, const char* noun) {
  return std::to_string(n) + " " + noun + (n == 1 ? "" : "s");
}

void print_line(const char* name, const std::string& text) {
  std::printf("%-9s %s\n", name, text.c_str());
}

void print_method(const scenes::RunResult& result, const scenes::RunPlan& plan) {
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
                          plural(s.substeps, "substep") + " each" +
                          (s.accuracy ? ", " + plural(result.total.repeated_steps, "step") + " done again, " +
                                            std::to_string(result.total.inaccurate_steps) +
                                            " taken though not accurate enough"
                                      : ""));
}

void print_summary(const RunOptions& options, const scenes::RunResult& result,
                   const scenes::Machine& machine) {
  const Settings& s = options.plan.settings;
  const WorldInfo& info = result.info;
  print_line("scene", options.scene + ": " + plural(info.particles, "particle") + ", " +
                          plural(info.rods, "rod") + ", " + plural(info.islands, "island"));
  const bool family =
      s.method == Method::automatic || s.method == Method::relax || s.method == Method::direct;
  const bool touches = info.linkages > 0;
  const bool relaxes = family && !touches && (info.relaxed_rods > 0 || info.direct_rods == 0);
  if (!family) print_method(result, options.plan);
  if (touches) {
    print_line("contact", "at most " + plural(result.total.contacts, "point") + " at once, " +
                              plural(result.total.block_sweeps, "sweep") + "; " +
                              plural(result.total.fell_asleep, "island") + " fell asleep, " +
                              std::to_string(result.total.awake_islands) + " awake at last; " +
                              plural(result.total.guarded_energy, "substep") + " kept from gaining energy");
  }
  if (info.direct_rods > 0 || touches) {
    print_line("direct",
               plural(info.direct_rods, "rod") + " solved all at once, gradient " +
                   std::string(to_string(info.direct_gradient)) +
                   (info.changes_gradient ? " (mid while calm)" : "") +
                   (info.direct_time_order == 2 ? std::string()
                                                : ", time order " + std::to_string(info.direct_time_order)) +
                   ", mass " + std::string(to_string(mass_model_of(s))) + ", " +
                   std::string(to_string(s.precision)) +
                   (s.accuracy ? ", accuracy " + short_number(*s.accuracy) : "") +
                   (s.stop.tolerance ? ", nets' tolerance " + short_number(*s.stop.tolerance) : ""));
    print_line("steps", plural(result.frames, "frame") + " of " + short_number(options.plan.dt) + " s, " +
                            plural(result.total.direct_substeps, "substep") + " of an island, " +
                            plural(result.total.newton, "Newton step") + ", " +
                            plural(result.total.halvings, "halving") + ", " +
                            plural(result.total.fallbacks, "fallback"));
  }
  if (relaxes) {
    Settings relaxed = s;
    relaxed.method = Method::relax;
    std::string stop = "at most " + plural(s.stop.sweeps, "sweep");
    if (s.stop.tolerance) stop += ", tolerance " + short_number(*s.stop.tolerance);
    if (s.stop.budget_us) stop += ", " + short_number(*s.stop.budget_us) + " µs a frame";
    print_line("relax", plural(info.relaxed_rods, "rod") + ", " + std::string(to_string(s.order)) +
                            ", gradient " + std::string(to_string(gradient_of(relaxed))) + ", weights " +
                            std::string(to_string(s.weights)) + ", omega " + short_number(s.omega) + ", " +
                            std::string(to_string(s.precision)));
    print_line("steps", plural(result.frames, "frame") + " of " + short_number(options.plan.dt) + " s, " +
                            plural(s.substeps, "substep") + " each, " + stop + " (stopped by " +
                            std::string(to_string(result.total.stopped_by)) + ")");
  }
  print_line("stretch", "RMS " + percent(result.stretch.rms) + ", max " + percent(result.stretch.max) +
                            " (rod " + std::to_string(result.stretch.max_rod) + ")");
  if (s.method == Method::springs && s.springs.model == SpringModel::rigid_rods)
    print_line("gaps", "at joints at most " + short_number(result.total.largest_gap) + " m, RMS at most " +
                           short_number(result.total.rms_gap) + " m");
  const scenes::EnergyDrift& energy = result.energy;
  print_line("energy", short_number(energy.initial) + " J at first, " + short_number(energy.final) +
                           " J at last, drift at most " +
                           (energy.range > 0 ? percent(energy.drift_max / energy.range) + " of the range"
                                             : short_number(energy.drift_max) + " J"));
  for (const scenes::PositionError& error : result.position_error) {
    print_line("error", short_number(error.rms_m) + " m at " + short_number(error.t) + " s, " +
                            percent(error.relative) + " of the scene's diagonal");
  }
  if (info.projected_position > 0) {
    print_line("start", "rods did not start at their lengths; particles moved by at most " +
                            short_number(info.projected_position) + " m");
  }
  if (info.unprojected_islands > 0) {
    print_line("start", "in " + plural(info.unprojected_islands, "island") +
                            " rods are not at their lengths and cannot be brought there without a velocity");
  }
  if (info.projected_velocity > 0) {
    print_line("velocity", "initial velocities pulled on rods; changed by at most " +
                               short_number(info.projected_velocity) + " m/s");
  }
  std::string time = short_number(1e3 * result.wall_s, 4) + " ms, " +
                     short_number(1e6 * result.wall_s / static_cast<double>(result.frames), 4) +
                     " µs a frame";
  if (info.rods > 0) time += ", " + short_number(result.ns_per_rod_frame(), 4) + " ns per rod and frame";
  print_line("time", time);
  print_line("machine", machine.cpu + ", " + machine.isa + ", " + plural(machine.threads, "thread"));
  print_line("state", scenes::hash_text(result.state_hash));
}

bool same_file(const std::filesystem::path& a, const std::filesystem::path& b) {
  using std::filesystem::absolute;
  using std::filesystem::weakly_canonical;
  return !b.empty() && weakly_canonical(absolute(a)) == weakly_canonical(absolute(b));
}

/// Every file that a run writes frame by frame. All are opened before the work: a folder that cannot be
/// written is better known then.
class SavedFrames {
 public:
  SavedFrames(const RunOptions& options, const Scene& scene) : binary_(options.gltf.ends_with(".glb")) {
    if (!options.trajectory.empty()) trajectory_.emplace(options.trajectory).write(scenes::trajectory_header);
    if (!options.vtk.empty()) vtk_.emplace(options.vtk, scene);
    if (options.gltf.empty()) return;
    gltf_file_.emplace(options.gltf);
    gltf_.emplace(scene);
  }

  bool wanted() const { return trajectory_ || vtk_ || gltf_; }

  void add(const Frame& frame) {
    if (trajectory_) {
      std::string rows;
      scenes::append_frame(rows, frame);
      trajectory_->write(rows);
    }
    if (vtk_) vtk_->add(frame);
    if (gltf_) gltf_->add(frame);
  }

  void commit() {
    if (trajectory_) trajectory_->commit();
    if (vtk_) vtk_->finish();
    if (!gltf_) return;
    gltf_file_->write(gltf_->to_text(binary_));
    gltf_file_->commit();
  }

 private:
  bool binary_;
  std::optional<scenes::OutputFile> trajectory_;
  std::optional<VtkSeries> vtk_;
  std::optional<scenes::OutputFile> gltf_file_;
  std::optional<GltfAnimation> gltf_;
};

void require_different_files(const RunOptions& options) {
  const std::pair<const char*, const std::string*> files[] = {
      {"--trajectory", &options.trajectory}, {"--report", &options.report}, {"--gltf", &options.gltf}};
  for (const auto& a : files)
    for (const auto& b : files) {
      if (&a >= &b || a.second->empty() || !same_file(*a.second, *b.second)) continue;
      throw InputError(std::string(a.first) + " and " + b.first + " name the same file, " + *b.second);
    }
}

int run(const RunOptions& options) {
  const Scene scene = scenes::load_scene(options.scene);
  std::vector<Frame> truth;
  if (!options.truth.empty()) truth = scenes::read_trajectory(options.truth);
  require_different_files(options);
  SavedFrames saved(options, scene);
  std::optional<scenes::OutputFile> report;
  if (!options.report.empty()) report.emplace(options.report);

  scenes::RunObserver observer;
  observer.save_at = options.save_at;
  if (saved.wanted()) observer.save = [&](const Frame& frame) { saved.add(frame); };
  scenes::RunResult result;
  {
    Progress progress("running", options.quiet);
    observer.progress = [&](std::uint64_t done, std::uint64_t all) { progress.show(done, all); };
    result = scenes::run_scene(scene, options.plan, truth, observer);
  }
  const scenes::Machine machine = scenes::describe_machine(result.info);
  if (report)
    report->write(scenes::format_json(scenes::report_json(options.scene, options.plan, result, machine)));
  saved.commit();
  if (report) report->commit();
  if (!options.quiet) print_summary(options, result, machine);
  if (!result.finite) throw CheckFailed("the state is not finite");
  if (result.total.frozen_islands > 0)
    throw CheckFailed(plural(result.total.frozen_islands, "island") +
                      " went non-finite; put back to the last finite state and left standing");
  if (result.total.unsolved > 0)
    throw CheckFailed(
        plural(result.total.unsolved, "substep") +
        " could not be solved: trees stayed where they were, islands with loops took elastic rods");
  return fine;
}

}  // namespace

void add_run_command(Command& plumb) {
  Command command = plumb.add_command("run", "Simulate a scene; say how fast and how wrong");
  auto options = std::make_shared<RunOptions>();
  RunOptions& o = *options;
  add_scene(command, o.scene);
  add_seconds(command, "--duration", o.plan.duration, "Simulated time, a whole number of frames [1]");
  add_seconds(command, "--dt", o.plan.dt, "Length of a frame [1/60]");
  add_solver_options(command, o.plan.settings);
  add_layout_options(command, o.plan.settings);
  add_save_at(
      command, o.save_at,
      "Times for the trajectory and the pictures, each the end of a frame or 0; without it every frame");
  command.add_option("--trajectory", "OUT.csv", o.trajectory, "Write t,particle,x,y,z,vx,vy,vz to this file");
  command.add_option("--vtk", "DIR", o.vtk,
                     "Write a VTK file (.vtp) per frame, and run.pvd, for ParaView, into this folder");
  command.add_option(
      "--gltf", "OUT.glb",
      [&o](const std::string& file) {
        if (!file.ends_with(".glb") && !file.ends_with(".gltf")) throw BadValue("must end in .glb or .gltf");
        o.gltf = file;
      },
      "Write an animation for Blender and others: OUT.glb, or OUT.gltf as text");
  command.add_option("--truth", "TRUTH.csv", o.truth, "Compare positions with this trajectory");
  command.add_option("--report", "OUT.json", o.report,
                     "Write settings, machine, time and errors to this file");
  command.add_flag("--quiet", o.quiet, "Print nothing but errors");
  command.set_footer(
      "Examples:\n"
      "  plumb run chain:links=100,end_mass=1000 --accuracy 1e-3\n"
      "  plumb run thesis5 --sweeps 1000\n"
      "  plumb run chain:end_mass=10 --substeps 8 --truth tools/scenes/truth/chain_N20_r10.csv\n"
      "  plumb run chain:end_mass=10 --substeps 8 --gradient mid --tolerance 1e-6 --report r.json\n"
      "  plumb run humanoid --duration 5 --gltf humanoid.glb --vtk frames\n"
      "  plumb run graph --duration 2 --save-at 1,2 --trajectory t.csv\n\n" +
      generators_help());
  command.set_action([options] { return run(*options); });
}

}  // namespace plumb::tools
