#pragma once

#include <cstdint>

#include "plumb/scene.hpp"
#include "plumb/settings.hpp"
#include "thesis/experiment.hpp"

/// These functions measure the thesis's stiff springs (sections 3.3 and 4.4.1).
namespace plumb::tools {

/// Returns settings of rigid rods with a spring at each joint.
Settings spring_settings(Integrator integrator, double stiffness, std::uint32_t substeps = 1);

/// A limit is the stiffness of all springs, in N/m, up to which a step of `step` s is stable.
struct SpringLimit {
  double predicted = 0;  ///< Limit that spring_stability() predicts.
  /// Limit found by bisection of runs without gravity, in which a tug grows a hundredfold or not.
  double found = 0;
};
SpringLimit find_spring_limit(const Scene& scene, Integrator integrator, double step);

/// A scene's chain hangs straight down from its first particle, at rest, until its springs have come to rest.
struct HangingGaps {
  double largest = 0;  ///< Largest gap at the joints of rigid rods, in m (figure 4.5).
  double rms = 0;      ///< RMS gap at these joints, in m.
  /// Gap that the top joint should have, in m: the weight of all links over the stiffness.
  double top_load = 0;
  double bottom_load = 0;  ///< Gap that the last link's joint should have, in m.
  /// Number of the most stretched spring between particles, counted from the top, on the same chain.
  std::uint32_t widest = 0;
};
HangingGaps measure_hanging_gaps(const Scene& scene, double stiffness);

/// These are gaps at the joints of rigid rods over one second of the scene's own motion from rest, in m. They
/// are the largest at any frame's end and the root mean square over frames.
struct MovingGaps {
  double largest = 0;
  double rms = 0;
};
MovingGaps measure_moving_gaps(const Scene& scene, const Settings& settings);

/// Returns frames of `step` s per second of stepping, over a second of motion, as the best of several runs.
/// It is NaN if an island was frozen.
double frames_per_second(const Scene& scene, const Settings& settings, double step);

}  // namespace plumb::tools
