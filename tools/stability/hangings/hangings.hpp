#pragma once

#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

#include "plumb/scene.hpp"
#include "plumb/world.hpp"

/// Random things hang from anchors: lines, nets, bridges, cranes and others, some of which cannot fit.
namespace plumb::scenes {

struct Hanging {
  std::string kind;
  Scene scene;
  bool must_move = false;  ///< It is slack and starts where it cannot stay.
};
/// Returns the scene of a seed, the same with every compiler. It has at most some 300 rods.
Hanging random_hanging(std::uint64_t seed);

/// Says what became of a hanging that was stepped with default settings, one thread and steps of 1/60 s.
struct HangingResult {
  std::uint64_t seed = 0;
  std::string kind;
  std::uint32_t rods = 0, frames = 0;
  StepReport total{};
  std::uint32_t named = 0;   ///< Frames after which World::problems() was not empty.
  std::uint32_t silent = 0;  ///< Frames with a rod off its length or an unsolved substep that were not named.
  bool finite = true;        ///< All positions were finite after every frame.
  bool stands_still = false;  ///< It must move and did not.
  /// Newton's steps, halvings and sweeps of the worst frame and of the median one. What hangs nearly still
  /// costs next to nothing, so that the median is over frames in which a particle moves faster than `rest`
  /// (m/s). Where those are fewer than `least_moving` it is over all frames with any work.
  double worst_work = 0, median_work = 0;
  static constexpr double rest = 0.02;
  static constexpr std::size_t least_moving = 10;

  /// Returns how many times the median's work the worst frame took.
  double work_ratio() const { return median_work > 0 ? worst_work / median_work : 0; }
  static constexpr double dear_ratio = 20;
  bool is_dear() const { return work_ratio() > dear_ratio; }
  /// Returns what is wrong with it, or nothing.
  std::string fault() const;
};
HangingResult hang(std::uint64_t seed, double duration);

}  // namespace plumb::scenes
