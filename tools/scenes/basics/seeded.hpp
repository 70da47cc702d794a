#pragma once

#include <random>

namespace plumb::scenes {

/// Returns the next number in [0, 1), from the upper 53 bits of the generator. The standard fixes what
/// mt19937_64 yields, but not what its distributions make of it. So scenes that must be the same everywhere
/// use this instead.
inline double unit_double(std::mt19937_64& random) {
  return static_cast<double>(random() >> 11) * 0x1p-53;
}

}  // namespace plumb::scenes
