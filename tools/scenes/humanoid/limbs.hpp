#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "plumb/scene.hpp"

/// These functions say what of a scene can be seen, for pictures and files of other programs.
namespace plumb::scenes {

/// A limb is all within `radius` of the line between two places. It is a ball if they are the same.
struct Limb {
  Point a{}, b{};
  double radius = 0;                        ///< Radius in m; 0 makes a line or a dot.
  std::optional<std::uint32_t> rod{};       ///< Rod whose ends it joins.
  std::optional<std::uint32_t> particle{};  ///< Particle around which it is a ball.
  bool is_ball() const;
};

/// Returns where a place is when the scene's particles are at `positions`, in m.
Vec3 place_of(const Point& point, std::span<const Vec3> positions);

/// Returns the capsules in the scene's order. Then come rods that no capsule is around and that belong to no
/// body with a capsule. Particles that are in none of these come last.
std::vector<Limb> list_limbs(const Scene& scene);

}  // namespace plumb::scenes
