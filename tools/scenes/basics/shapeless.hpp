#pragma once

#include <algorithm>
#include <cstdint>
#include <vector>

#include "plumb/scene.hpp"

namespace plumb::scenes {

inline bool has_ground(const Scene& scene) {
  return !scene.planes.empty() || !scene.boxes.empty() || !scene.ground_capsules.empty() ||
         !scene.ground_hulls.empty() || !scene.meshes.empty() || !scene.height_fields.empty();
}

/// Counts movable particles that no shape is placed by. Those of a body have what any of them has.
inline std::uint32_t count_shapeless(const Scene& scene) {
  std::vector<std::uint8_t> shaped(scene.particles.size(), 0);
  for (const Capsule& capsule : scene.capsules)
    for (const Point& point : {capsule.a, capsule.b})
      for (std::size_t k = 0; k < 4; ++k)
        if (point.weights[k] != 0) shaped[point.particles[k]] = 1;
  std::vector<std::uint8_t> has_hull(scene.bodies.size(), 0);
  for (const Hull& hull : scene.hulls) has_hull[hull.body] = 1;
  for (std::size_t i = 0; i < scene.bodies.size(); ++i) {
    const auto& of_body = scene.bodies[i].particles;
    if (has_hull[i] != 0 ||
        std::any_of(of_body.begin(), of_body.end(), [&](auto p) { return shaped[p] != 0; }))
      for (const std::uint32_t particle : of_body) shaped[particle] = 1;
  }
  std::uint32_t count = 0;
  for (std::size_t i = 0; i < shaped.size(); ++i) count += !scene.particles[i].fixed && shaped[i] == 0;
  return count;
}

}  // namespace plumb::scenes
