#include "scenes/runs/run.hpp"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <limits>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <utility>

#include "plumb/error.hpp"
#include "scenes/basics/lists.hpp"
#include "scenes/basics/numbers.hpp"
#include "scenes/basics/require.hpp"
#include "scenes/runs/saved_run.hpp"

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

namespace {

/// Refuses rates at which a rod would be gone before the run ends.
void require_lengths(const Scene& scene, const RunPlan& plan) {
  for (const auto& [rod, rate] : plan.rates) {
    if (rod >= scene.rods.size()) continue;  // the world says so
    const double length = rod_length(scene, rod);
    if (length + rate * plan.duration > 0) continue;
    throw InputError("rod " + std::to_string(rod) + ": at " + short_number(rate) +
                     " m/s nothing is left of its " + short_number(length) + " m after " +
                     seconds(-length / rate) + ", and the run takes " + seconds(plan.duration));
  }
}

/// A world on its way through a plan, with what is measured of it.
class Run {
 public:
  Run(const std::shared_ptr<const Scene>& shared, const RunPlan& plan, std::span<const Frame> truth,
      const RunObserver& observer)
      : scene_(*shared),
        plan_(plan),
        observer_(observer),
        frames_(count_frames(plan)),
        save_(frames_to_save(observer, plan, frames_)),
        compare_(frames_to_compare(truth, plan, frames_, scene_.particles.size())),
        world_(shared, plan.settings),
        now_(make_frame(scene_, plan.settings)),
        result_{.info = world_.info()} {
    require_lengths(scene_, plan);
    world_.set_budget(plan.step_budget_us);
    if (plan.times_stages)
      world_.set_zones([this](std::string_view stage, bool begins) { time_stage(stage, begins); });
  }

  RunResult whole() {
    const std::uint64_t first = resume();
    begin();
    if (first == 0) visit(0);
    for (std::uint64_t number = first + 1; goes_on() && number <= frames_; ++number) {
      step(number);
      visit(number);
      measure();
      if (observer_.progress) observer_.progress(number, frames_);
    }
    if (observer_.ended) observer_.ended(world_);
    result_.end = world_.time();
    result_.is_whole = first + result_.frames == frames_;
    result_.stretch.rms =
        std::sqrt(squares_ / static_cast<double>(std::max<std::uint64_t>(result_.frames, 1)));
    result_.wall_s = std::chrono::duration<double>(wall_).count();
    result_.problems = world_.problems();
    result_.state_hash = world_.state_hash();
    return std::move(result_);
  }

 private:
  using Clock = std::chrono::steady_clock;

  bool goes_on() const { return !observer_.goes_on || observer_.goes_on(world_); }

  /// Returns the number of the frame to go on from, which is 0 without a snapshot.
  std::uint64_t resume() {
    if (plan_.resume.empty()) return 0;
    restore_run(world_, plan_);
    result_.start = world_.time();
    const auto frame = frame_at(result_.start, plan_.dt);
    const std::string at = plan_.resume + ": the snapshot is of " + seconds(result_.start);
    if (!frame) throw InputError(at + ", where no frame of " + seconds(plan_.dt) + " ends");
    if (*frame >= frames_)
      throw InputError(at + ", and the run ends at " + seconds(plan_.duration) +
                       ": ask for a longer --duration");
    set_measured_lengths(result_.start);
    leave_out_broken();
    return *frame;
  }

  void begin() {
    copy_state(world_, now_);
    result_.energy.initial = result_.energy.final = energy();
    result_.energy.range = energy_range(scene_);
  }

  double energy() const { return energy_of(world_, measured(), now_, mass_model_of(plan_.settings)); }

  void set_measured_lengths(double t) {
    for (const auto& [rod, rate] : plan_.rates)
      changed().rods[rod].length = rod_length(scene_, rod) + rate * t;
  }

  /// Takes from what is measured what rods that broke hold.
  void leave_out_broken() {
    for (std::uint32_t i = 0; i < scene_.rods.size(); ++i)
      if (world_.is_broken(i)) changed().rods[i].law = {.stiffness = 0};
  }

  /// Returns the scene without what has broken, with lengths of now.
  const Scene& measured() const { return changed_ ? *changed_ : scene_; }
  Scene& changed() {
    if (!changed_) changed_ = scene_;
    return *changed_;
  }

  void time_stage(std::string_view stage, bool begins) {
    if (begins) {
      stage_begin_ = Clock::now();
      return;
    }
    const double s = std::chrono::duration<double>(Clock::now() - stage_begin_).count();
    for (StageTime& each : result_.stages)
      if (each.name == stage) {
        each.s += s;
        return;
      }
    result_.stages.push_back({stage, s});
  }

  void step(std::uint64_t number) {
    const double end = static_cast<double>(number) * plan_.dt;
    const auto start = Clock::now();
    set_lengths(world_, scene_, plan_.rates, end);
    const StepReport step = world_.step(plan_.dt);
    wall_ += Clock::now() - start;
    ++result_.frames;
    if (plan_.step_budget_us && step.step_us > *plan_.step_budget_us) ++result_.late_frames;
    result_.longest_step_us = std::max(result_.longest_step_us, step.step_us);
    set_measured_lengths(end);
    if (step.broken_rods > 0) leave_out_broken();
    result_.total += step;
  }

  /// Looks at the end of a frame, and hands it on if it is to be saved.
  void visit(std::uint64_t number) {
    copy_state(world_, now_);
    find_largest(now_, result_);
    result_.finite = result_.finite && all_finite(now_);
    if (const auto it = compare_.find(number); it != compare_.end()) {
      result_.position_error.push_back(position_error(now_, *it->second, diagonal_));
      add_tension_error(now_, *it->second, result_);
    }
    const auto it = save_.find(number);
    if (!observer_.save || (it == save_.end() && !observer_.save_at.empty())) return;
    now_.t = it != save_.end() ? it->second : static_cast<double>(number) * plan_.dt;
    if (!now_.forces.is_empty()) copy_forces(world_, now_.forces);
    if (plan_.settings.contacts) now_.contacts = world_.contacts();
    observer_.save(now_);
  }

  void measure() {
    const Stretch stretch = measure_stretch(measured(), now_.positions);
    squares_ += stretch.rms * stretch.rms;
    keep_worst(stretch, result_.stretch);
    result_.energy.final = energy();
    const double drift = std::abs(result_.energy.final - result_.energy.initial);
    if (!(drift <= result_.energy.drift_max) && !std::isnan(result_.energy.drift_max))
      result_.energy.drift_max = drift;
  }

  const Scene& scene_;
  const RunPlan& plan_;
  const RunObserver& observer_;
  std::uint64_t frames_;
  std::map<std::uint64_t, double> save_;
  std::map<std::uint64_t, const Frame*> compare_;
  double diagonal_ = bounding_diagonal(scene_);
  World world_;
  Clock::time_point stage_begin_{};
  std::optional<Scene> changed_;  ///< What is measured, where it is no longer the scene itself.
  RunFrame now_;
  RunResult result_;
  double squares_ = 0;
  Clock::duration wall_{};
};

}  // namespace

RunResult run_scene(const std::shared_ptr<const Scene>& scene, const RunPlan& plan,
                    std::span<const Frame> truth, const RunObserver& observer) {
  return Run(scene, plan, truth, observer).whole();
}

RunResult run_scene(const Scene& scene, const RunPlan& plan, std::span<const Frame> truth,
                    const RunObserver& observer) {
  return run_scene(std::make_shared<const Scene>(scene), plan, truth, observer);
}

}  // namespace plumb::scenes
