#pragma once

#include <cstdint>
#include <vector>

#include "plumb/scene.hpp"
#include "plumb/world.hpp"

namespace plumb::view {

/// A scene as a running world leaves it, from which another world goes on.
struct Carried {
  Scene scene;
  /// Numbers of rods in `scene`, by their numbers before; `no_rod` for those that are gone.
  std::vector<std::uint32_t> rod_numbers;
};
inline constexpr std::uint32_t no_rod = 0xffffffff;

/// Says what has become of a scene's items beside what a world tells.
struct Remains {
  std::vector<std::uint32_t> rod_numbers;  ///< Numbers of the scene's rods in the world; `no_rod` if gone.
  std::vector<std::uint8_t> asleep;        ///< By particle, whether it sleeps.
};

/// Returns `scene` with positions, velocities, poses, lengths and sleepers of `world`. Rods that are gone are
/// left out, with bends and twists that need them. Particles that `world` does not have yet are as in
/// `scene`. What the world has taken in of turns of torsions is lost beyond half a turn.
Carried carry(const Scene& scene, const World& world, const Remains& remains);

/// Returns a number for each particle, equal where rods, bends, tackles, joints, springs and bodies tie
/// movable ones together. Rods that are gone do not count. A fixed particle has no island: `no_island`.
std::vector<std::uint32_t> find_islands(const Scene& scene, const std::vector<std::uint32_t>& rod_numbers);
inline constexpr std::uint32_t no_island = 0xffffffff;

}  // namespace plumb::view
