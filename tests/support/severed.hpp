#pragma once

#include <cstdint>

#include "plumb/plumb.hpp"
#include "support/bodies.hpp"
#include "support/figures.hpp"

/// Figures that tests sever.
namespace plumb::test {

inline void step(World& world, int times) {
  for (int i = 0; i < times; ++i) world.step(frame);
}

template <class Item>
void cut(World& world, std::uint32_t number = 0) {
  world.cut(world.handle<Item>(number));
}

/// Takes out all that holds the two bodies of a figure together.
inline void sever(World& world, const Added& first = {}) {
  cut<Pin>(world, first.pin);
  cut<Alignment>(world, first.alignment);
  cut<AngleControl>(world, first.angle);
  cut<Spring>(world, first.spring);
  cut<Torsion>(world, first.torsion);
}

/// Lets what a scene has turn about a place, and fly.
inline void set_flying(Scene& scene, Vec3 center) {
  scene.gravity = {};
  for (Particle& each : scene.particles)
    if (!each.fixed) each.velocity = Vec3{1, 2, 0.5} + cross(Vec3{0.7, -0.4, 2}, each.position - center);
}

/// A figure that turns and flies, and a crate far away that does so, too.
inline Scene thrown() {
  Scene scene;
  add_figure(scene, {0, 2, 0});
  set_flying(scene, {0, 1.8, 0});
  add_crate(scene, {9, 2, 0});
  scene.particles.back().velocity = {0, 1, 0};
  return scene;
}

}  // namespace plumb::test
