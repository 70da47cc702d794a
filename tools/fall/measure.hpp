#pragma once

#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "plumb/measures.hpp"
#include "plumb/scene.hpp"
#include "plumb/settings.hpp"
#include "plumb/world.hpp"

namespace plumb::tools {

/// A fall is a scene in which things land, and how it is moved.
struct Fall {
  std::string scene;  ///< As for `plumb run`.
  Settings settings{};
  std::uint32_t frames = 90;
  double dt = 1.0 / 60;                ///< Length of a frame, in s.
  std::vector<std::uint32_t> shown{};  ///< Frames to keep, in order. Frame 0 is the start.
};

/// Says what came of a fall.
struct FallResult {
  std::size_t rods = 0;
  double mean_s = 0, median_s = 0, worst_s = 0;  ///< Time of a frame.
  double stretch = 0;                            ///< Largest strain at any frame's end.
  double depth = 0;                              ///< How deep an end of a shape ever was in ground, in m.
  double last_depth = 0;                         ///< How deep one is at last, in m.
  StepReport total{};
  bool finite = true;
  std::vector<Frame> shown{};
};

FallResult run_fall(const Fall& fall);

/// Returns the slope of time over rods, both as logarithms, through the first and the last result.
double growth(const FallResult& first, const FallResult& last);

}  // namespace plumb::tools
