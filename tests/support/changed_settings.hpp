#pragma once

#include <gtest/gtest.h>

#include <cstdint>
#include <string>
#include <vector>

#include "plumb/plumb.hpp"
#include "support/worlds.hpp"

/// What tests share of settings that change while a world runs.
namespace plumb::test {

/// Appends a rope of rods of 0.1 m from a place, along a way. It hangs from its first particle, or flies.
inline std::uint32_t add_rope(Scene& scene, Vec3 from, Vec3 way, std::uint32_t rods, bool hangs) {
  const auto first = static_cast<std::uint32_t>(scene.particles.size());
  for (std::uint32_t i = 0; i <= rods; ++i)
    scene.particles.push_back({.position = from + 0.1 * i * way, .mass = 0.1, .fixed = hangs && i == 0});
  for (std::uint32_t i = 0; i < rods; ++i) scene.rods.push_back({.a = first + i, .b = first + i + 1});
  return first;
}

/// Appends a net of particles 0.1 m apart that hangs from two corners.
inline std::uint32_t add_net(Scene& scene, Vec3 from, std::uint32_t side) {
  const auto first = static_cast<std::uint32_t>(scene.particles.size());
  for (std::uint32_t i = 0; i < side; ++i)
    for (std::uint32_t j = 0; j < side; ++j) {
      scene.particles.push_back({.position = from + Vec3{0.1 * i, 0, 0.1 * j},
                                 .mass = 0.1,
                                 .fixed = j == 0 && (i == 0 || i + 1 == side)});
      const std::uint32_t here = first + i * side + j;
      if (j > 0) scene.rods.push_back({.a = here - 1, .b = here});
      if (i > 0) scene.rods.push_back({.a = here - side, .b = here});
    }
  return first;
}

/// Ropes that swing, a ring, and a net: islands of each kind that methods tell apart.
inline Scene swinging() {
  Scene scene;
  for (int i = 0; i < 3; ++i) add_rope(scene, {0, 0, 1.0 * i}, {1, 0, 0}, 6, true);
  const std::uint32_t ring = add_rope(scene, {3, 0, 0}, {1, 0, 0}, 3, true);
  scene.particles.push_back({.position = {3.15, 0.08, 0}, .mass = 0.2});
  for (const std::uint32_t end : {ring, ring + 3}) scene.rods.push_back({.a = end, .b = ring + 4});
  add_net(scene, {6, 0, 0}, 6);
  return scene;
}

/// Ropes with shapes, of which two lie on a floor and on each other and one falls, and a box of rods with a
/// spring.
inline Scene touching() {
  Scene scene;
  scene.planes.push_back({.normal = {0, 1, 0}, .offset = 0});
  const auto add = [&](Vec3 from, Vec3 way, std::uint32_t rods, bool hangs) {
    const std::uint32_t first = add_rope(scene, from, way, rods, hangs);
    for (std::uint32_t i = first; i < first + rods; ++i)
      scene.capsules.push_back({.a = point_at(i), .b = point_at(i + 1), .radius = 0.02});
    return first;
  };
  add({0, 0.02, 0}, {1, 0, 0}, 8, false);
  add({0.42, 0.06, -0.3}, {0, 0, 1}, 6, false);
  add({0.3, 0.8, 0.4}, {1, 0, 0}, 5, false);
  const std::uint32_t sprung = add({-1, 1.5, 0}, {1, 0, 0}, 5, true);
  scene.springs.push_back(
      {.a = point_at(sprung), .b = point_at(sprung + 3), .length = 0.28, .stiffness = 20, .damping = 0.5});
  return scene;
}

/// Settings of a method that moves all of these scenes.
inline Settings settings_of(Method method) {
  Settings settings{.method = method, .substeps = 4, .threads = 1};
  if (method == Method::relax) settings.stop.sweeps = 60;
  return settings;
}

inline constexpr Method methods[] = {Method::automatic, Method::direct, Method::relax};

/// Calls f(settings before, settings after) for every change of method.
template <class F>
void for_changes(F&& f) {
  for (const Method from : methods)
    for (const Method to : methods) {
      if (from == to) continue;
      SCOPED_TRACE(std::string(to_string(from)) + " to " + std::string(to_string(to)));
      f(settings_of(from), settings_of(to));
    }
}

/// All particles' positions and velocities, bit for bit.
struct Motion {
  std::vector<Vec3> positions, velocities;

  friend bool operator==(const Motion&, const Motion&) = default;
};
inline Motion motion_of(const World& world) {
  return {positions_of(world), velocities_of(world)};
}

}  // namespace plumb::test
