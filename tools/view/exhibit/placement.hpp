#pragma once

#include <cstdint>
#include <vector>

#include "plumb/scene.hpp"

namespace plumb::view {

/// Says how relaxation lays rods out where the choice of layouts is left to it, in single precision.
struct Placement {
  std::vector<std::uint32_t> color_of_rod;  ///< Colour of the graph; rods of one are projected at once.
  std::vector<std::uint32_t> lane_of_rod;   ///< Place in the vector of rods that is projected at once.
};
/// Stands for rods between fixed particles, which have neither.
inline constexpr std::uint32_t no_place = 0xffffffff;

/// Places the rods of a scene in its numbering. Near linear time.
Placement place_rods(const Scene& scene);

}  // namespace plumb::view
