#pragma once

#include <cstdint>

#include "plumb/layouts/memory.hpp"
#include "plumb/scene.hpp"

namespace plumb::detail {

/// These numbers of rods and particles, in the scene's order, are kept so that weights can change between
/// steps.
struct Constants {
  Array<double> length2;         ///< Squared lengths are in m^2, per rod.
  Array<double> inverse_mass;    ///< Inverse masses are in 1/kg, per particle; fixed ones have 0.
  Array<std::uint32_t> valence;  ///< So many rods meet at each particle.
  Array<RodLaw> laws;            ///< Laws are per rod; there are none if all rods are rigid.
};

Constants make_constants(const Scene& scene);

}  // namespace plumb::detail
