#pragma once

#include <cmath>
#include <cstdint>

#include "plumb/scene.hpp"

namespace plumb::scenes {

/// Tells which rod that neither gives nor may be slack starts farthest off its length.
struct StartStrain {
  std::uint32_t rod = 0;
  double strain = 0;  ///< Negative if its particles are too close.
};

inline StartStrain start_strain(const Scene& scene) {
  StartStrain out;
  if (!scene.reels.empty()) return out;  // What is wound is not as long as it seems.
  for (std::uint32_t i = 0; i < scene.rods.size(); ++i) {
    const Rod& rod = scene.rods[i];
    if (rod.length == 0 || rod.law.is_elastic() || rod.law.one_sided) continue;
    const double distance = norm(scene.particles[rod.b].position - scene.particles[rod.a].position);
    const double strain = distance / rod.length - 1;
    if (std::abs(strain) > std::abs(out.strain)) out = {i, strain};
  }
  return out;
}

}  // namespace plumb::scenes
