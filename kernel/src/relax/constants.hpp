#pragma once

#include <cstdint>
#include <vector>

#include "plumb/scene.hpp"

namespace plumb::detail {

/// These numbers of rods and particles, in the scene's order, are kept so that weights can change between
/// steps.
struct Constants {
  std::vector<double> length2;         ///< Squared lengths are in m^2, per rod.
  std::vector<double> inverse_mass;    ///< Inverse masses are in 1/kg, per particle; fixed ones have 0.
  std::vector<std::uint32_t> valence;  ///< So many rods meet at each particle.
  std::vector<RodLaw> laws;            ///< Laws are per rod; there are none if all rods are rigid.
};

Constants make_constants(const Scene& scene);

}  // namespace plumb::detail
