#pragma once

#include <chrono>

namespace plumb::scenes {

/// All measurements read this clock, which never goes back.
using Clock = std::chrono::steady_clock;

inline double seconds_since(Clock::time_point start) {
  return std::chrono::duration<double>(Clock::now() - start).count();
}

}  // namespace plumb::scenes
