#pragma once

#include <cstdint>

#include "support/worlds.hpp"

/// Chains whose rods break.
namespace plumb::test {

/// A rigid rod, a rigid cable, and elastic ones.
inline constexpr RodLaw breaking_laws[] = {{},
                                           {.one_sided = true},
                                           {.stiffness = 1e5, .damping = 50},
                                           {.stiffness = 1e5, .damping = 50, .one_sided = true}};

/// Returns a chain that hangs straight down, with 2 kg at its end. Its third rod has a strength of 60 N.
inline Scene hanging_chain(const RodLaw& law) {
  Scene scene;
  for (std::uint32_t i = 0; i <= 6; ++i) {
    const Vec3 at{0, -0.2 * i, 0};
    scene.particles.push_back(i == 0 ? fixed(at) : movable(at, i == 6 ? 2 : 0.3));
    if (i > 0) scene.rods.push_back({.a = i - 1, .b = i, .law = law});
  }
  scene.rods[2].law.strength = 60;
  return scene;
}

inline std::uint32_t broken_rods(const World& world) {
  std::uint32_t count = 0;
  for (std::uint32_t i = 0; i < world.rod_count(); ++i) count += world.is_broken(i) ? 1 : 0;
  return count;
}

}  // namespace plumb::test
