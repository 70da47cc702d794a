// plumb run simulates a scene and says how fast and how wrong.
#include <cmath>
#include <cstdio>
#include <filesystem>
#include <memory>
#include <optional>

#include "cli/checkpoint.hpp"
#include "cli/commands.hpp"
#include "cli/options.hpp"
#include "cli/progress.hpp"
#include "cli/run_summary.hpp"
#include "export/gltf.hpp"
#include "export/vtk.hpp"
#include "plumb/error.hpp"
#include "plumb/world.hpp"
#include "scenes/basics/files.hpp"
#include "scenes/basics/numbers.hpp"
#include "scenes/files/contacts.hpp"
#include "scenes/files/scene_file.hpp"
#include "scenes/files/trajectory.hpp"
#include "scenes/runs/report.hpp"
#include "scenes/runs/saved_run.hpp"
#include "scenes/spec.hpp"
#include "view/inputs/replay.hpp"

namespace plumb::tools {
namespace {

struct RunOptions {
  std::string scene;
  scenes::RunPlan plan;
  std::vector<double> save_at;
  std::string trajectory;
  std::string tensions, forces, contacts;
  std::string truth, truth_tensions;
  std::string report;
  std::string vtk;        ///< Folder for VTK files.
  std::string gltf;       ///< File for the glTF animation.
  std::string save;       ///< File for snapshots.
  std::string end_scene;  ///< File for the scene at the end.
  double save_every = 0;  ///< Simulated time between them in s; 0 stands for ten seconds of computing.
  std::string replay;     ///< File that the page of plumb view saved.
  bool quiet = false;
};

/// Writes every file that a run fills frame by frame. All are opened before the work, since a folder that
/// cannot be written is better known then.
class SavedFrames {
 public:
  SavedFrames(const RunOptions& options, const Scene& scene)
      : scene_(scene), binary_(options.gltf.ends_with(".glb")) {
    if (!options.trajectory.empty()) trajectory_.emplace(options.trajectory).write(scenes::trajectory_header);
    if (!options.tensions.empty()) tensions_.emplace(options.tensions).write(scenes::tensions_header);
    if (!options.forces.empty()) forces_.emplace(options.forces).write(scenes::forces_header);
    if (!options.contacts.empty()) contacts_.emplace(options.contacts).write(scenes::contacts_header);
    if (!options.vtk.empty()) vtk_.emplace(options.vtk, scene);
    if (options.gltf.empty()) return;
    gltf_file_.emplace(options.gltf);
    gltf_.emplace(scene);
  }

  bool wanted() const { return trajectory_ || tensions_ || forces_ || contacts_ || vtk_ || gltf_; }

  void add(const scenes::RunFrame& frame) {
    if (trajectory_) {
      std::string rows;
      scenes::append_frame(rows, frame);
      trajectory_->write(rows);
    }
    if (tensions_) {
      std::string rows;
      scenes::append_tensions(rows, frame);
      tensions_->write(rows);
    }
    if (forces_) {
      std::string rows;
      scenes::append_forces(rows, frame.t, scene_, frame.forces);
      forces_->write(rows);
    }
    if (contacts_) {
      std::string rows;
      scenes::append_contacts(rows, frame.t, frame.contacts);
      contacts_->write(rows);
    }
    if (vtk_) vtk_->add(frame);
    if (gltf_) gltf_->add(frame);
  }

  void commit() {
    if (trajectory_) trajectory_->commit();
    if (tensions_) tensions_->commit();
    if (forces_) forces_->commit();
    if (contacts_) contacts_->commit();
    if (vtk_) vtk_->finish();
    if (!gltf_) return;
    gltf_file_->write(gltf_->to_text(binary_));
    gltf_file_->commit();
  }

 private:
  const Scene& scene_;
  bool binary_;
  std::optional<scenes::OutputFile> trajectory_, tensions_, forces_, contacts_;
  std::optional<VtkSeries> vtk_;
  std::optional<scenes::OutputFile> gltf_file_;
  std::optional<GltfAnimation> gltf_;
};

/// Throws CheckFailed if something went wrong on the way.
void require_sound(const scenes::RunResult& result) {
  if (!result.finite) throw CheckFailed("the state is not finite");
  if (result.total.frozen_islands > 0)
    throw CheckFailed(plural(result.total.frozen_islands, "island") +
                      " went non-finite; put back to the last finite state and left standing");
  if (result.total.unsolved > 0)
    throw CheckFailed(plural(result.total.unsolved, "substep") +
                      " could not be solved, not even with elastic rods");
}

/// Refuses options that nothing of a run would read.
void require_read(const RunOptions& options, const Scene& scene) {
  if (options.save_every > 0 && options.save.empty())
    throw InputError("--save-every says when to write the file of --save, and there is none");
  const bool writes = !options.trajectory.empty() || !options.tensions.empty() || !options.forces.empty() ||
                      !options.contacts.empty() || !options.vtk.empty() || !options.gltf.empty();
  if (!options.save_at.empty() && !writes)
    throw InputError(
        "--save-at says when to write files of frames, such as that of --trajectory, and there "
        "are none");
  if (!has_more_than_rods(scene) &&
      options.plan.settings.contact.length_scale != ContactSettings{}.length_scale)
    throw InputError("--length-scale: nothing reads it: nothing of this scene can touch");
}

/// Refuses options that were given their defaults where nothing reads them. The kernel cannot tell those from
/// none, so that a world is asked for something else.
void require_defaults_read(const std::string& typed, const Scene& scene, const Settings& settings) {
  const Settings usual;
  const auto ask = [&](const std::string& option, auto is_usual, auto change) {
    if (typed.find(" " + option + " ") == std::string::npos || !is_usual(settings)) return;
    Settings other = settings;
    change(other);
    const World world(scene, other);
  };
  ask(
      "--sweeps", [&](const Settings& s) { return s.stop.sweeps == usual.stop.sweeps; },
      [](Settings& s) { ++s.stop.sweeps; });
  ask(
      "--omega", [&](const Settings& s) { return s.omega == usual.omega; },
      [](Settings& s) { s.omega = 1.5; });
  ask(
      "--weights", [&](const Settings& s) { return s.weights == usual.weights; },
      [](Settings& s) { s.weights = Weights::equal; });
  ask(
      "--order", [&](const Settings& s) { return s.order == usual.order; },
      [](Settings& s) { s.order = SweepOrder::jacobi; });
  ask(
      "--stiffness", [&](const Settings& s) { return s.springs.stiffness == usual.springs.stiffness; },
      [](Settings& s) { s.springs.stiffness *= 2; });
  ask(
      "--damping-ratio",
      [&](const Settings& s) { return s.springs.damping_ratio == usual.springs.damping_ratio; },
      [](Settings& s) { s.springs.damping_ratio *= 2; });
}

int run(const RunOptions& options, const std::string& typed) {
  const auto shared = std::make_shared<const Scene>(scenes::load_scene(options.scene));
  const Scene& scene = *shared;
  require_read(options, scene);
  require_defaults_read(typed, scene, options.plan.settings);
  std::vector<Frame> truth;
  if (!options.truth.empty()) truth = scenes::read_trajectory(options.truth);
  if (!options.truth_tensions.empty()) scenes::read_tensions(options.truth_tensions, truth);
  require_different_files({{"--trajectory", options.trajectory},
                           {"--tensions", options.tensions},
                           {"--forces", options.forces},
                           {"--contacts", options.contacts},
                           {"--report", options.report},
                           {"--gltf", options.gltf},
                           {"--save", options.save},
                           {"--end-scene", options.end_scene}});
  SavedFrames saved(options, scene);
  std::optional<scenes::OutputFile> report, end_scene;
  if (!options.report.empty()) report.emplace(options.report);
  if (!options.end_scene.empty()) end_scene.emplace(options.end_scene);

  scenes::RunObserver observer;
  observer.save_at = options.save_at;
  if (saved.wanted()) observer.save = [&](const scenes::RunFrame& frame) { saved.add(frame); };
  std::optional<Checkpoint> checkpoint;
  if (!options.save.empty()) {
    checkpoint.emplace(options.save, scenes::run_text(options.scene, options.plan),
                       options.save_every > 0 ? std::optional(options.save_every) : std::nullopt);
    observer.goes_on = [&](const World& world) { return checkpoint->see(world); };
  }
  observer.ended = [&](const World& world) {
    if (checkpoint) checkpoint->write(world);
    if (end_scene) end_scene->write(scenes::format_scene(world.scene()));
  };
  scenes::RunResult result;
  {
    Progress progress("running", options.quiet);
    observer.progress = [&](std::uint64_t done, std::uint64_t all) { progress.show(done, all); };
    result = scenes::run_scene(shared, options.plan, truth, observer);
  }
  const scenes::Machine machine = scenes::describe_machine(result.info);
  if (report)
    report->write(scenes::format_json(scenes::report_json(options.scene, options.plan, result, machine)));
  saved.commit();
  if (report) report->commit();
  if (end_scene) end_scene->commit();
  if (!options.quiet) print_run_summary(options.scene, scene, options.plan, result, machine);
  require_sound(result);
  if (!result.is_whole)
    throw CheckFailed("stopped at " + scenes::short_number(result.end, 12) + " s; --resume " + options.save +
                      " goes on from there");
  return fine;
}

/// Returns the option that was typed for a setting. Several files ask for tensions.
std::string typed_option(const UnreadSetting& error, const RunOptions& options) {
  if (error.setting() != "tensions") return option_of(error.setting());
  return !options.tensions.empty() ? "--tensions" : !options.forces.empty() ? "--forces" : "--truth-tensions";
}

/// Repeats what a page did, in all of its worlds, and compares their hashes with those that it saved.
int repeat(const std::string& file) {
  const view::Replay replay = view::parse_replay(scenes::read_file(file), file);
  const view::Exhibit end = view::repeat(replay);
  const std::vector<std::string> hashes = view::hashes_of(end);
  std::printf("%-9s %s\n", "scene", replay.start.name.c_str());
  std::printf("%-9s %s, %s\n", "replay", plural(replay.frames, "frame").c_str(),
              plural(replay.inputs.size(), "input").c_str());
  for (std::size_t i = 0; i < hashes.size(); ++i)
    std::printf("%-9s %s %s\n", "state", hashes[i].c_str(), end.sides()[i].name().c_str());
  std::fflush(stdout);
  if (hashes != replay.hashes) throw CheckFailed("the bits differ from those of when the replay was saved");
  std::printf("%-9s the same as when it was saved\n", "bits");
  return fine;
}

/// A file for what is counted only if a setting asks for it.
struct CountedFile {
  RunOptions& options;
  std::string& name;
  bool Settings::*asks;
};

void add_counted(Command& command, const char* option, const char* value, const CountedFile& file,
                 const char* help) {
  command.add_option(
      option, value,
      [file](const std::string& given) {
        file.name = given;
        file.options.plan.settings.*file.asks = true;
      },
      help);
}

/// Adds the files that frames are written to.
void add_files(Command& command, RunOptions& o) {
  command.add_option("--trajectory", "OUT.csv", o.trajectory, "Write t,particle,x,y,z,vx,vy,vz to this file");
  add_counted(command, "--tensions", "OUT.csv", {o, o.tensions, &Settings::tensions},
              "Write t,rod,tension to this file: how rods pull, in N, in files of --vtk too");
  add_counted(
      command, "--forces", "OUT.csv", {o, o.forces, &Settings::tensions},
      "Write t,kind,number,x,y,z to this file: what holds anchors, joints, springs and shapes, likewise");
  add_counted(
      command, "--contacts", "OUT.csv", {o, o.contacts, &Settings::contacts},
      "Write t,a,b,phase,x,y,z,nx,ny,nz,ix,iy,iz,speed to this file: which shapes touched in the frame");
  command.add_option("--end-scene", "OUT.json", o.end_scene,
                     "Write the scene as it is at the end, such as a pile that has settled");
  command.add_option("--vtk", "DIR", o.vtk,
                     "Write a VTK file (.vtp) per frame, and run.pvd, for ParaView, into this folder");
  command.add_option(
      "--gltf", "OUT.glb",
      [&o](const std::string& file) {
        if (!file.ends_with(".glb") && !file.ends_with(".gltf")) throw BadValue("must end in .glb or .gltf");
        o.gltf = file;
      },
      "Write an animation for Blender and others: OUT.glb, or OUT.gltf as text");
}

/// Adds what asks how long steps take, and bounds it.
void add_clock(Command& command, scenes::RunPlan& plan) {
  command.add_flag("--stages", plan.times_stages, "Tell how long the stages of steps took");
  command.add_option(
      "--step-budget", "U",
      [&plan](const std::string& text) {
        const auto value = scenes::parse_number<double>(text);
        if (!value || !(*value > 0) || !std::isfinite(*value))
          throw BadValue("'" + text + "' is not a positive number");
        plan.step_budget_us = *value;
      },
      "Fit every step into this many microseconds, by fewer substeps or less accuracy; results then depend "
      "on the clock");
}

constexpr const char* examples =
    "Examples:\n"
    "  plumb run chain:links=100,end_mass=1000 --accuracy 1e-3\n"
    "  plumb run winch --winch 0:-0.5 --substeps 4 --trajectory hauled.csv\n"
    "  plumb run thesis5 --method relax --sweeps 1000\n"
    "  plumb run chain:end_mass=10 --substeps 8 --truth tools/scenes/truth/chain_N20_r10.csv\n"
    "  plumb run chain:end_mass=10 --method relax --substeps 8 --gradient mid --tolerance 1e-6 --report "
    "r.json\n"
    "  plumb run humanoid --duration 5 --gltf humanoid.glb --vtk frames\n"
    "  plumb run graph --duration 2 --save-at 1,2 --trajectory t.csv\n"
    "  plumb run heap --duration 60 --save heap.snapshot\n"
    "  plumb run heap --duration 90 --resume heap.snapshot\n"
    "  plumb run --replay replay.json\n\n";

}  // namespace

void add_run_command(Command& plumb) {
  Command command = plumb.add_command("run", "Simulate a scene; say how fast and how wrong");
  auto options = std::make_shared<RunOptions>();
  RunOptions& o = *options;
  const Option scene =
      command.add_option("SCENE", "", o.scene, "A scene file (.json) or a generator; see below");
  add_seconds(command, "--duration", o.plan.duration, "Simulated time, a whole number of frames [1]");
  add_seconds(command, "--dt", o.plan.dt, "Length of a frame [1/60]");
  add_winches(command, o.plan.rates);
  add_solver_options(command, o.plan.settings);
  add_layout_options(command, o.plan.settings);
  add_save_at(
      command, o.save_at,
      "Times for the trajectory and the pictures, each the end of a frame or 0; without it every frame");
  add_files(command, o);
  command.add_option("--save", "OUT.snapshot", o.save,
                     "Keep a snapshot in this file: every 10 s of computing, on Ctrl-C and at the end");
  add_seconds(command, "--save-every", o.save_every, "Keep it after every so much simulated time instead");
  command.add_option("--resume", "IN.snapshot", o.plan.resume,
                     "Go on from a snapshot of the same scene and settings, up to --duration");
  add_clock(command, o.plan);
  command.add_option("--truth", "TRUTH.csv", o.truth, "Compare positions with this trajectory");
  add_counted(command, "--truth-tensions", "TENSIONS.csv", {o, o.truth_tensions, &Settings::tensions},
              "Compare tensions with these, at times of --truth");
  command.add_option("--report", "OUT.json", o.report,
                     "Write settings, machine, time and errors to this file");
  const Option replay = command.add_option(
      "--replay", "FILE", o.replay,
      "Repeat what a page of plumb view saved, with its scene and settings, and compare the bits");
  command.add_flag("--quiet", o.quiet, "Print nothing but errors");
  command.check([command, scene, replay, &o] {
    if (!replay.given() && !scene.given()) throw InputError("SCENE is required");
    if (replay.given() && command.typed() != " --replay " + o.replay)
      throw InputError("--replay takes scene and settings from its file, and goes with no other option");
  });
  command.set_footer(
      [&o] { return std::string(examples) + methods_help() + "\n" + generators_help(o.scene); });
  command.set_action([options, command] {
    if (!options->replay.empty()) return repeat(options->replay);
    try {
      return run(*options, command.typed());
    } catch (const UnreadSetting& error) {
      throw InputError(typed_option(error, *options) + ": " + error.what());
    }
  });
}

}  // namespace plumb::tools
