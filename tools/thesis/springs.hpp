#pragma once

#include <cstdint>

#include "plumb/scene.hpp"
#include "plumb/settings.hpp"
#include "thesis/experiment.hpp"

/// The thesis's stiff springs (sections 3.3 and 4.4.1), measured.
namespace plumb::tools {

/// Rigid rods with a spring at each joint.
Settings spring_settings(Integrator integrator, double stiffness, std::uint32_t substeps = 1);

/// The same stiffness in every spring, N/m, up to which a step of `step` s is stable.
struct SpringLimit {
  double predicted = 0;  ///< by spring_stability()
  double found = 0;      ///< by bisection of runs without gravity, in which a tug grows a hundredfold or not
};
SpringLimit find_spring_limit(const Scene& scene, Integrator integrator, double step);

/// A scene's chain hung straight down from its first particle, at rest, until its springs have come to rest.
struct HangingGaps {
  double largest = 0;      ///< m, of the joints of rigid rods (figure 4.5)
  double rms = 0;          ///< m
  double top_load = 0;     ///< m, weight of all links over the stiffness: what the top joint gives by
  double bottom_load = 0;  ///< m, the same of the last link
  std::uint32_t widest =
      0;  ///< the most stretched of the same chain's springs between particles, from the top
};
HangingGaps measure_hanging_gaps(const Scene& scene, double stiffness);

/// Of the joints of rigid rods, over one second of the scene's own motion from rest, m: the largest at any
/// frame's end and the mean square over frames, rooted.
struct MovingGaps {
  double largest = 0;
  double rms = 0;
};
MovingGaps measure_moving_gaps(const Scene& scene, const Settings& settings);

/// Frames of `step` s per second of stepping, over a second of motion; the best of several runs. NaN if an
/// island was frozen.
double frames_per_second(const Scene& scene, const Settings& settings, double step);

}  // namespace plumb::tools
