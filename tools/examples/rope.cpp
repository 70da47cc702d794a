// A rope hangs from an anchor: describe a scene, compile it, step it, read it.
#include <cstdint>
#include <cstdio>
#include <plumb/plumb.hpp>

int main() {
  plumb::Scene scene;  // Units are metres, kilograms and seconds.
  scene.drag = 1;      // Air brakes the rope at 1/s, so that it comes to rest.
  scene.particles.push_back({.position = {0, 0, 0}, .fixed = true});
  for (std::uint32_t i = 1; i <= 20; ++i) {
    scene.particles.push_back({.position = {0.1 * i, 0, 0}, .mass = 0.05});
    scene.rods.push_back({.a = i - 1, .b = i});  // A rod is as long as the two are apart.
  }

  plumb::World world(scene, {.substeps = 16});
  for (int frame = 0; frame < 20 * 60; ++frame) world.step(1.0 / 60);

  const plumb::Vec3 tip = world.position(20);
  std::printf("after %.0f s the tip hangs %.2f m below the anchor, %.2f m aside\n", world.time(), -tip.y,
              tip.x < 0 ? -tip.x : tip.x);
}
