#pragma once

#include <cmath>
#include <cstdint>
#include <limits>
#include <string>

#include "plumb/error.hpp"

/// Generators and runs ask this of their parameters. All throw InputError.
namespace plumb::scenes {

inline void require_positive(double value, const char* name) {
  if (!(value > 0) || !std::isfinite(value)) {
    throw InputError(std::string(name) + " must be positive and finite");
  }
}

inline void require_not_negative(double value, const char* name) {
  if (!(value >= 0) || !std::isfinite(value)) {
    throw InputError(std::string(name) + " must be at least 0 and finite");
  }
}

/// Returns the coefficient.
inline double require_friction(double value) {
  require_not_negative(value, "friction");
  return value;
}

inline void require_at_least(std::uint64_t value, std::uint64_t least, const char* name) {
  if (value < least) throw InputError(std::string(name) + " must be at least " + std::to_string(least));
}

/// Particle ids are 32 bits wide, and the limit leaves room for as many rods.
inline void require_countable(std::uint64_t particles) {
  if (particles > std::numeric_limits<std::int32_t>::max()) {
    throw InputError("that is " + std::to_string(particles) +
                     " particles; at most 2147483647 can be numbered");
  }
}

}  // namespace plumb::scenes
