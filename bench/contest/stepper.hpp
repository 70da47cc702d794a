#pragma once

#include <cstdint>

#include "plumb/measures.hpp"

namespace plumb::bench {

/// s, the frame of every scene here; one substep.
inline constexpr double frame_length = 1.0 / 60;

/// Something that steps a scene and can be timed.
class Stepper {
 public:
  virtual ~Stepper() = default;
  /// Makes `steps` steps of `sweeps` sweeps each, and returns seconds per step.
  virtual double run(std::uint32_t steps, std::uint32_t sweeps) = 0;
  /// From now on steps may make only `most_sweeps` sweeps and take the others to last as long: outside the
  /// caches baselines would otherwise take most of a run. Worlds make all.
  virtual void extrapolate_beyond(std::uint32_t most_sweeps) { static_cast<void>(most_sweeps); }
  /// Of the scene that it was made from.
  virtual Stretch stretch(const Scene& scene) const = 0;
};

}  // namespace plumb::bench
