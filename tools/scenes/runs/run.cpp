#include "scenes/runs/run.hpp"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <limits>
#include <map>
#include <string>

#include "plumb/error.hpp"
#include "scenes/basics/lists.hpp"
#include "scenes/basics/numbers.hpp"
#include "scenes/basics/require.hpp"

namespace plumb::scenes {
namespace {

std::string seconds(double t) {
  return short_number(t, 12) + " s";
}

/// Maps a frame's number to the time as the user wrote it: 0.1 is saved as 0.1, not as six sixtieths.
std::map<std::uint64_t, double> frames_to_save(const RunObserver& observer, const RunPlan& plan,
                                               std::uint64_t frames) {
  std::map<std::uint64_t, double> out;
  for (const double t : observer.save_at) {
    const auto frame = frame_at(t, plan.dt);
    if (!frame) {
      throw InputError("no frame ends at the time to save, " + seconds(t) + ": frames are " +
                       seconds(plan.dt) + " long");
    }
    if (*frame > frames) {
      throw InputError("the time to save, " + seconds(t) + ", is after the end at " + seconds(plan.duration));
    }
    out[*frame] = t;
  }
  return out;
}

/// Maps a frame's number to the truth at its end.
std::map<std::uint64_t, const Frame*> frames_to_compare(std::span<const Frame> truth, const RunPlan& plan,
                                                        std::uint64_t frames, std::size_t particles) {
  std::map<std::uint64_t, const Frame*> out;
  std::string times;
  for (const Frame& frame : truth) {
    if (frame.positions.size() != particles) {
      throw InputError("the truth has " + std::to_string(frame.positions.size()) + " particles, the scene " +
                       std::to_string(particles));
    }
    append_item(times, short_number(frame.t, 12));
    const auto number = frame_at(frame.t, plan.dt);
    if (number && *number <= frames) out[*number] = &frame;
  }
  if (!truth.empty() && out.empty()) {
    throw InputError("nothing to compare: none of the truth's times (" + times +
                     " s) is the end of a frame of " + seconds(plan.dt) + " within " +
                     seconds(plan.duration));
  }
  return out;
}

bool all_finite(const Frame& frame) {
  return std::all_of(frame.positions.begin(), frame.positions.end(), is_finite) &&
         std::all_of(frame.velocities.begin(), frame.velocities.end(), is_finite);
}

/// Takes from a scene that is measured what its rods that broke hold.
void leave_out_broken(const World& world, Scene& measured) {
  for (std::uint32_t i = 0; i < measured.rods.size(); ++i)
    if (world.is_broken(i)) measured.rods[i].law = {.stiffness = 0};
}

/// Returns the energy of a world, in J. What bends and rods hold is as `measured` says.
double energy_of(const World& world, const Scene& measured, const Frame& now, MassModel mass) {
  double energy = measure_energy(measured, now.positions, now.velocities, mass).total();
  for (std::uint32_t i = 0; i < measured.twists.size(); ++i)
    energy += twist_energy(measured, i, world.twist(i));
  return energy;
}

RunFrame make_frame(const Scene& scene, const Settings& settings) {
  RunFrame frame;
  frame.positions.resize(scene.particles.size());
  frame.velocities.resize(scene.particles.size());
  if (!settings.tensions) return frame;
  frame.tensions.resize(scene.rods.size());
  frame.forces = make_forces(scene);
  return frame;
}

void add_tension_error(const Frame& frame, const Frame& truth, RunResult& result) {
  if (frame.tensions.empty() || truth.tensions.empty()) return;
  result.tension_error.push_back(tension_error(frame, truth));
}

/// Looks for the rod that pulls or pushes most.
void find_largest(const Frame& frame, RunResult& result) {
  for (std::uint32_t rod = 0; rod < frame.tensions.size(); ++rod) {
    if (!(std::abs(frame.tensions[rod]) > result.largest_tension)) continue;
    result.largest_tension = std::abs(frame.tensions[rod]);
    result.most_tense_rod = rod;
  }
}

void keep_worst(const Stretch& now, Stretch& worst) {
  // It is written so that a value that is not a number wins and stays.
  if (now.max <= worst.max || std::isnan(worst.max)) return;
  worst.max = now.max;
  worst.max_rod = now.max_rod;
}

void copy_state(const World& world, Frame& frame) {
  world.copy_positions(frame.positions);
  world.copy_velocities(frame.velocities);
  if (!frame.tensions.empty()) world.copy_tensions(frame.tensions);
}

}  // namespace

double RunResult::ns_per_rod_frame() const {
  if (info.rods == 0 || frames == 0) return std::numeric_limits<double>::quiet_NaN();
  return wall_s * 1e9 / (static_cast<double>(info.rods) * static_cast<double>(frames));
}

void set_lengths(World& world, const Scene& scene, std::span<const LengthRate> rates, double t) {
  for (const auto& [rod, rate] : rates) world.set_length(rod, rod_length(scene, rod) + rate * t);
}

std::optional<std::uint64_t> frame_at(double t, double dt) {
  const double frames = t / dt;
  const double nearest = std::round(frames);
  // Times come as decimals, dt as a rounded fraction. Both are good to some 1e-16 of themselves.
  if (!(nearest >= 0) || nearest > 1e15 || std::abs(frames - nearest) > 1e-6) return {};
  return static_cast<std::uint64_t>(nearest);
}

std::uint64_t count_frames(const RunPlan& plan) {
  require_positive(plan.dt, "dt");
  require_positive(plan.duration, "the duration");
  const auto frames = frame_at(plan.duration, plan.dt);
  if (!frames || *frames == 0) {
    const double below = std::max(1.0, std::floor(plan.duration / plan.dt));
    throw InputError("the duration, " + seconds(plan.duration) + ", is not a whole number of frames of " +
                     seconds(plan.dt) + "; " + std::to_string(static_cast<std::uint64_t>(below)) +
                     " frames would be " + seconds(below * plan.dt));
  }
  return *frames;
}

RunResult run_scene(const Scene& scene, const RunPlan& plan, std::span<const Frame> truth,
                    const RunObserver& observer) {
  using Clock = std::chrono::steady_clock;
  const std::uint64_t frames = count_frames(plan);
  const auto save = frames_to_save(observer, plan, frames);
  const auto compare = frames_to_compare(truth, plan, frames, scene.particles.size());
  const double diagonal = bounding_diagonal(scene);

  const MassModel mass = mass_model_of(plan.settings);
  World world(scene, plan.settings);
  Scene measured = scene;  // without what has broken
  RunResult result{.info = world.info(), .frames = frames};
  RunFrame now = make_frame(scene, plan.settings);
  const auto visit = [&](std::uint64_t number) {
    copy_state(world, now);
    find_largest(now, result);
    result.finite = result.finite && all_finite(now);
    if (const auto it = compare.find(number); it != compare.end()) {
      result.position_error.push_back(position_error(now, *it->second, diagonal));
      add_tension_error(now, *it->second, result);
    }
    const auto it = save.find(number);
    if (!observer.save || (it == save.end() && !observer.save_at.empty())) return;
    now.t = it != save.end() ? it->second : static_cast<double>(number) * plan.dt;
    if (!now.forces.is_empty()) copy_forces(world, now.forces);
    if (plan.settings.contacts) now.contacts = world.contacts();
    observer.save(now);
  };

  visit(0);
  result.energy.initial = result.energy.final = energy_of(world, measured, now, mass);
  result.energy.range = energy_range(scene);
  double squares = 0;
  Clock::duration wall{};
  for (std::uint64_t number = 1; number <= frames; ++number) {
    const double end = static_cast<double>(number) * plan.dt;
    const auto start = Clock::now();
    set_lengths(world, scene, plan.rates, end);
    const StepReport step = world.step(plan.dt);
    wall += Clock::now() - start;
    for (const auto& [rod, rate] : plan.rates)
      measured.rods[rod].length = rod_length(scene, rod) + rate * end;
    if (step.broken_rods > 0) leave_out_broken(world, measured);
    result.total += step;
    visit(number);
    const Stretch stretch = measure_stretch(measured, now.positions);
    squares += stretch.rms * stretch.rms;
    keep_worst(stretch, result.stretch);
    result.energy.final = energy_of(world, measured, now, mass);
    const double drift = std::abs(result.energy.final - result.energy.initial);
    if (!(drift <= result.energy.drift_max) && !std::isnan(result.energy.drift_max))
      result.energy.drift_max = drift;
    if (observer.progress) observer.progress(number, frames);
  }
  result.stretch.rms = std::sqrt(squares / static_cast<double>(frames));
  result.wall_s = std::chrono::duration<double>(wall).count();
  result.problems = world.problems();
  result.state_hash = world.state_hash();
  return result;
}

}  // namespace plumb::scenes
