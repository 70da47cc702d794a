#pragma once

#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "plumb/measures.hpp"
#include "plumb/scene.hpp"
#include "plumb/settings.hpp"
#include "plumb/shapes/contact.hpp"
#include "plumb/world.hpp"
#include "scenes/basics/length_rate.hpp"
#include "scenes/files/forces.hpp"
#include "scenes/files/trajectory.hpp"

namespace plumb::scenes {

/// A plan is a stretch of simulated time in equal frames. World::step(dt) is called once for each.
struct RunPlan {
  Settings settings{};
  double duration = 1;              ///< Simulated time in s, a whole number of frames.
  double dt = 1.0 / 60;             ///< Length of a frame in s, which Settings::substeps divides further.
  std::vector<LengthRate> rates{};  ///< Rods that are reeled in or paid out all the time.
  bool times_stages = false;        ///< Whether RunResult::stages is known, for 0.5 us a step.
  std::optional<double> step_budget_us{};  ///< Wall time of a step (World::set_budget()), in us.
  /// File with a snapshot (World::save()) to go on from, up to `duration`; empty stands for the scene's
  /// start.
  std::string resume{};
};

/// A saved frame has forces and contacts if the settings ask for tensions and contacts. The latter are the
/// world's and hold until its next step.
struct RunFrame : Frame {
  Forces forces{};
  std::span<const Contact> contacts{};
};

/// An observer sees a run on its way. All functions may be empty. The time they take is not measured.
struct RunObserver {
  /// Takes a frame. Frame 0 is the scene as it starts. A run that goes on from a snapshot begins with the
  /// frame after it.
  std::function<void(const RunFrame&)> save;
  std::vector<double> save_at;  ///< Frame ends to hand to `save`, in s; empty stands for every frame.
  /// Takes the frames done and the frames in all.
  std::function<void(std::uint64_t, std::uint64_t)> progress;
  /// Takes the world before the first frame and after each, and says whether the run goes on.
  std::function<bool(const World&)> goes_on;
  /// Takes the world after the last frame.
  std::function<void(const World&)> ended;
};

/// Energies are in J, as measure_energy() has them. Rods whose length changes do work, which is in them.
struct EnergyDrift {
  double initial = 0;  ///< Where the run starts, or goes on.
  double final = 0;
  double drift_max = 0;  ///< Largest distance from `initial` at any frame's end.
  double range = 0;      ///< The scene's energy_range().
};

/// Time of a stage of all steps (World::set_zones()).
struct StageTime {
  std::string_view name{};
  double s = 0;
};

/// A result says what came of a run. Strain is over the ends of all frames, without the start; its RMS is
/// over frames and rods.
struct RunResult {
  WorldInfo info{};
  double start = 0, end = 0;  ///< Times in s: of the snapshot that the run went on from, and of its end.
  std::uint64_t frames = 0;   ///< Frames that were stepped.
  bool is_whole = true;       ///< Whether the run was not stopped by its observer.
  StepReport total{};
  double wall_s = 0;                ///< Time in World::step alone, in s.
  std::uint64_t late_frames = 0;    ///< Frames whose step took more than its budget.
  double longest_step_us = 0;       ///< The longest of them and of the others, with a budget.
  std::vector<StageTime> stages{};  ///< Those of a step that the scene needs, in their order.
  Stretch stretch{};
  EnergyDrift energy{};
  std::vector<PositionError> position_error{};
  std::vector<TensionError> tension_error{};  ///< Where the truth has tensions and the run has.
  double largest_tension = 0;                 ///< In N, the largest pull or push at any frame's end.
  std::uint32_t most_tense_rod = 0;           ///< The rod that had it.
  std::vector<Problem> problems{};            ///< Those of the last frame.
  std::uint64_t state_hash = 0;
  bool finite = true;  ///< Whether every position and velocity was finite at every frame's end.

  bool sound() const { return finite && total.frozen_islands == 0; }
  /// Returns nanoseconds of stepping per rod and frame; NaN without rods.
  double ns_per_rod_frame() const;
};

/// Lets rods be as long at the end of the world's next step as they are at time `t` (s).
void set_lengths(World& world, const Scene& scene, std::span<const LengthRate> rates, double t);

/// Returns the number of the frame that ends at time `t`, to within a millionth of a frame, or none.
std::optional<std::uint64_t> frame_at(double t, double dt);

/// Returns the frames that the plan's duration takes. Throws InputError if it is not a whole number, at least
/// one.
std::uint64_t count_frames(const RunPlan& plan);

/// Steps a new world, which shares the scene, through the plan and measures it at every frame's end.
/// Positions are compared with those times of `truth` that are frame ends. Throws what World throws. Before
/// the first step it throws InputError if a time to be saved is no frame end or comes after the end. It also
/// does so if the truth has another number of particles, or none of its times can be compared. So it does if
/// the snapshot to go on from cannot be read, is of another scene or other settings, or leaves no frame to be
/// stepped.
RunResult run_scene(const std::shared_ptr<const Scene>& scene, const RunPlan& plan,
                    std::span<const Frame> truth = {}, const RunObserver& observer = {});
/// Does so with a copy of the scene, which has the world as well as the caller.
RunResult run_scene(const Scene& scene, const RunPlan& plan, std::span<const Frame> truth = {},
                    const RunObserver& observer = {});

}  // namespace plumb::scenes
