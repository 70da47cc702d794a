#pragma once

#include <cmath>
#include <cstdint>

#include "plumb/plumb.hpp"
#include "support/graphs.hpp"
#include "support/worlds.hpp"

namespace plumb::test {

/// A beam of length 1 m, bending stiffness 1 N m^2 and mass 1 kg along `axis`, clamped at the origin. Its tip
/// is the last particle. Gravity is off.
inline Scene cantilever(std::uint32_t rods, Vec3 axis = {1, 0, 0}) {
  const double l = 1.0 / rods;
  Scene scene;
  scene.gravity = {};
  scene.particles = {fixed(-l * axis), fixed({})};
  for (std::uint32_t i = 1; i <= rods; ++i) {
    scene.particles.push_back(movable(i * l * axis, i == rods ? l / 2 : l));
    scene.rods.push_back({.a = i, .b = i + 1, .length = l});
    scene.bends.push_back({.a = i - 1, .b = i, .c = i + 1, .stiffness = (i == 1 ? 2 : 1) / l});
  }
  return scene;
}

/// The same beam in the air, bent to an arc that turns by `turn` (rad) from end to end.
inline Scene free_beam(std::uint32_t rods, double turn) {
  Scene scene;
  scene.gravity = {};
  const double l = 1.0 / rods;
  Vec3 at{};
  for (std::uint32_t i = 0; i <= rods; ++i) {
    scene.particles.push_back(movable(at, i == 0 || i == rods ? l / 2 : l));
    const double phi = turn * i / rods;
    at += l * Vec3{std::cos(phi), std::sin(phi), 0};
    if (i > 0) scene.rods.push_back({.a = i - 1, .b = i, .length = l});
    if (i > 1) scene.bends.push_back({.a = i - 2, .b = i - 1, .c = i, .stiffness = 1 / l});
  }
  return scene;
}

inline void give_velocities(Scene& scene, unsigned seed) {
  Random random(seed);
  for (Particle& particle : scene.particles) {
    const double x = signed_unit(random), y = signed_unit(random), z = signed_unit(random);
    if (!particle.fixed) particle.velocity = {x, y, z};
  }
}

}  // namespace plumb::test
