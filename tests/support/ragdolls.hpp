#pragma once

#include <cstdint>

#include "plumb/plumb.hpp"

namespace plumb::test {

/// Adds a limb of a ragdoll: a solid capsule between two places (m).
inline std::uint32_t add_limb(Scene& scene, Vec3 from, Vec3 to, double mass, double radius) {
  const std::uint32_t body = add_body(scene, solid_capsule(mass, radius, from, to));
  scene.capsules.push_back(
      {.a = point_on_body(scene, body, from), .b = point_on_body(scene, body, to), .radius = radius});
  return body;
}

/// Adds a ragdoll of ten limbs and nine ball joints that stands with its feet at a place (m), its arms held
/// sideways. Returns its torso.
inline std::uint32_t add_ragdoll(Scene& scene, Vec3 feet) {
  const auto at = [&](double y, double z) { return feet + Vec3{0, y, z}; };
  const auto join = [&](std::uint32_t a, std::uint32_t b, Vec3 place) {
    add_spherical(scene, point_on_body(scene, a, place), point_on_body(scene, b, place));
  };
  const std::uint32_t torso = add_limb(scene, at(1, 0), at(1.4, 0), 30, 0.12);
  join(torso, add_limb(scene, at(1.65, 0), at(1.72, 0), 4, 0.1), at(1.53, 0));
  for (const double side : {-1.0, 1.0}) {
    const std::uint32_t thigh = add_limb(scene, at(0.85, 0.1 * side), at(0.5, 0.1 * side), 8, 0.07);
    join(torso, thigh, at(0.9, 0.1 * side));
    join(thigh, add_limb(scene, at(0.4, 0.1 * side), at(0.08, 0.1 * side), 5, 0.05), at(0.45, 0.1 * side));
    const std::uint32_t arm = add_limb(scene, at(1.4, 0.2 * side), at(1.4, 0.45 * side), 3, 0.045);
    join(torso, arm, at(1.4, 0.17 * side));
    join(arm, add_limb(scene, at(1.4, 0.5 * side), at(1.4, 0.75 * side), 2, 0.04), at(1.4, 0.475 * side));
  }
  return torso;
}

}  // namespace plumb::test
