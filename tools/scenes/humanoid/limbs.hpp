#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "plumb/scene.hpp"

/// What of a scene can be seen, for pictures and files of other programs.
namespace plumb::scenes {

/// All within `radius` of the line between two places, or a ball if they are the same.
struct Limb {
  Point a{}, b{};
  double radius = 0;                        ///< m; 0: a line or a dot
  std::optional<std::uint32_t> rod{};       ///< whose ends it joins
  std::optional<std::uint32_t> particle{};  ///< around which it is a ball
  bool is_ball() const;
};

/// Where a place is when the scene's particles are at `positions`, in m.
Vec3 place_of(const Point& point, std::span<const Vec3> positions);

/// The capsules in the scene's order, then the rods that no capsule is around and that are no part of a body
/// with a capsule of its own, then the particles that are in none of these.
std::vector<Limb> list_limbs(const Scene& scene);

}  // namespace plumb::scenes
