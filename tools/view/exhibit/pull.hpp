#pragma once

#include <cstdint>

#include "plumb/scene.hpp"
#include "plumb/world.hpp"

/// How a hand pulls a particle. All of it is here, so that another way takes its place in one file.
namespace plumb::view {

/// Says what is pulled where to.
struct Hand {
  std::uint32_t particle = 0;
  Vec3 target{};    ///< In m.
  double mass = 0;  ///< Mass of the particle in kg, with its share of rods and bodies.
  double dt = 0;    ///< Length of a step, in s.
};

/// Pulls during the next step. An anchor moves there by a fifth of the way. Others are pulled by a damped
/// spring whose force holds for a step. With the particle alone, k dt²/m = 1/4 and c dt/m = 1/2 are well
/// inside of what is stable, and what hangs on it only makes it slower. Throws InputError if the world
/// refuses.
void pull(World& world, const Scene& scene, const Hand& hand);

/// Ends the pull.
void let_go(World& world, const Scene& scene, const Hand& hand);

}  // namespace plumb::view
