#pragma once

#include <cstdint>

namespace plumb::scenes {

/// A rod is reeled in or paid out: its length changes at a constant rate from the start on.
struct LengthRate {
  std::uint32_t rod = 0;
  double rate = 0;  ///< Rate, in m/s; below 0 it becomes shorter.
};

}  // namespace plumb::scenes
