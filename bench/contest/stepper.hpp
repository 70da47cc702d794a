#pragma once

#include <cstdint>

#include "plumb/measures.hpp"

namespace plumb::bench {

/// Every scene here has frames of this length (s), each of one substep.
inline constexpr double frame_length = 1.0 / 60;

/// Steps a scene and can be timed.
class Stepper {
 public:
  virtual ~Stepper() = default;
  /// Makes `steps` steps of `sweeps` sweeps each, and returns seconds per step.
  virtual double run(std::uint32_t steps, std::uint32_t sweeps) = 0;
  /// Lets steps make only `most_sweeps` sweeps from now on, and take the others to last as long. Outside the
  /// caches baselines would otherwise take most of a run. Worlds make all sweeps.
  virtual void extrapolate_beyond(std::uint32_t most_sweeps) { static_cast<void>(most_sweeps); }
  /// Returns the stretch of the scene that it was made from.
  virtual Stretch stretch(const Scene& scene) const = 0;
};

}  // namespace plumb::bench
