#pragma once

#include <cstdint>
#include <vector>

#include "plumb/scene.hpp"

namespace plumb::detail {

/// What rods and particles weigh, in the scene's order; kept so that weights can change between steps.
struct Constants {
  std::vector<double> length2;         ///< m^2, per rod
  std::vector<double> inverse_mass;    ///< 1/kg, per particle; 0 if fixed
  std::vector<std::uint32_t> valence;  ///< rods at each particle
};

Constants make_constants(const Scene& scene);

}  // namespace plumb::detail
