#pragma once

#include <cstdint>
#include <span>
#include <string_view>

#include "plumb/scene.hpp"
#include "scenes/basics/seeded.hpp"

namespace plumb::scenes {

/// What is shot at. The first six are walls about y = 0, of ground.
enum class Target : std::uint8_t {
  sheet,
  box,
  boxes,
  hull,
  solid_mesh,
  height_field,
  rope,  ///< It is slack between two anchors, as the net is within a frame of them.
  net,
  flying_rope,  ///< It flies, as what follows does.
  flying_net,
  figure,
  flying_box
};
std::span<const Target> all_targets();
std::string_view to_string(Target);
bool is_wall(Target);

inline constexpr double wall_reach = 8;         ///< Half the width of a wall, in m.
inline constexpr double wall_thickness = 0.01;  ///< Half of that of walls that are solid, in m.

/// Adds a target to an empty scene. `radius` (m) is that of what is shot at it, through which a net's meshes
/// must not let it. Returns the particles along a side of a net, or 0.
std::uint32_t add_target(Scene& scene, Target target, double radius, const Surface& surface, Random& random);

}  // namespace plumb::scenes
