#pragma once

#include <cstdint>

namespace plumb::scenes {

/// The length of a rod changes at a constant rate from the start on, as by a winch.
struct LengthRate {
  std::uint32_t rod = 0;
  double rate = 0;  ///< Rate, in m/s; below 0 it becomes shorter.
};

}  // namespace plumb::scenes
