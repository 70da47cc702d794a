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
  /// Of the scene that it was made from.
  virtual Stretch stretch(const Scene& scene) const = 0;
};

}  // namespace plumb::bench
