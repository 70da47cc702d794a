#pragma once

#include <cstdint>
#include <functional>
#include <optional>
#include <span>
#include <vector>

#include "plumb/measures.hpp"
#include "plumb/scene.hpp"
#include "plumb/settings.hpp"
#include "plumb/world.hpp"
#include "scenes/files/trajectory.hpp"

namespace plumb::scenes {

/// A stretch of simulated time in equal frames: World::step(dt) is called once for each.
struct RunPlan {
  Settings settings{};
  double duration = 1;   ///< s, a whole number of frames
  double dt = 1.0 / 60;  ///< s, of a frame; Settings::substeps divides it further
};

/// What a run shows on its way; both may be empty. The time they take is not measured.
struct RunObserver {
  std::function<void(const Frame&)> save;  ///< frame 0 is the scene as it starts
  std::vector<double> save_at;             ///< s, frame ends to hand to `save`; empty: every frame
  std::function<void(std::uint64_t, std::uint64_t)> progress;  ///< frames done, frames in all
};

/// Energies in J, as measure_energy() has them.
struct EnergyDrift {
  double initial = 0;
  double final = 0;
  double drift_max = 0;  ///< largest distance from `initial` at any frame end
  double range = 0;      ///< energy_range() of the scene
};

/// What came of a run. Stretch is over the ends of all frames, the start not counted: RMS over frames and
/// rods.
struct RunResult {
  WorldInfo info{};
  std::uint64_t frames = 0;
  StepReport total{};
  double wall_s = 0;  ///< in World::step alone
  Stretch stretch{};
  EnergyDrift energy{};
  std::vector<PositionError> position_error{};
  std::uint64_t state_hash = 0;
  bool finite = true;  ///< every position and velocity, at every frame end

  bool sound() const { return finite && total.frozen_islands == 0; }
  /// Nanoseconds of stepping per rod and frame; NaN without rods.
  double ns_per_rod_frame() const;
};

/// The number of the frame that ends at time `t`, to within a millionth of a frame; none if none does.
std::optional<std::uint64_t> frame_at(double t, double dt);

/// The frames that the plan's duration takes. Throws InputError if it is not a whole number, at least one.
std::uint64_t count_frames(const RunPlan& plan);

/// Steps a new world through the plan and measures it at every frame end. Positions are compared with those
/// times of `truth` that are frame ends. Throws InputError, before the first step, if a time to be saved is
/// no frame end or comes after the end, if the truth has another number of particles, or if none of its times
/// can be compared; and what World throws.
RunResult run_scene(const Scene& scene, const RunPlan& plan, std::span<const Frame> truth = {},
                    const RunObserver& observer = {});

}  // namespace plumb::scenes
