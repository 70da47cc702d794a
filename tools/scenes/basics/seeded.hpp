#pragma once

#include <cmath>
#include <cstdint>
#include <random>

#include "plumb/vec3.hpp"

namespace plumb::scenes {

/// Returns the next number in [0, 1), from the upper 53 bits of the generator. The standard fixes what
/// mt19937_64 yields, but not what its distributions make of it. So scenes that must be the same everywhere
/// use this instead.
inline double unit_double(std::mt19937_64& random) {
  return static_cast<double>(random() >> 11) * 0x1p-53;
}

/// Draws what random scenes are made of, from a seed.
class Random {
 public:
  explicit Random(std::uint64_t seed) : engine_(seed) {}
  double between(double low, double high) { return low + (high - low) * unit_double(engine_); }
  /// Returns a number whose logarithm is even.
  double scaled(double low, double high) { return low * std::pow(high / low, unit_double(engine_)); }
  std::uint32_t count(std::uint32_t low, std::uint32_t high) {
    return low + static_cast<std::uint32_t>(unit_double(engine_) * (high - low + 1));
  }
  bool chance(double share) { return unit_double(engine_) < share; }
  /// Returns a place in the cube from -1 to 1.
  Vec3 in_cube() {
    const double x = between(-1, 1), y = between(-1, 1), z = between(-1, 1);
    return {x, y, z};
  }

 private:
  std::mt19937_64 engine_;
};

}  // namespace plumb::scenes
