// A slack bridge hangs between two anchors, with 2 m of rods over a gap of 1.6 m. At rest it is a catenary,
// which sags by 0.53 m.
#include <cstdint>
#include <cstdio>
#include <plumb/plumb.hpp>

int main() {
  constexpr std::uint32_t rods = 20, middle = rods / 2;
  plumb::Scene scene;
  scene.drag = 2;
  // Two straight halves meet at the bottom. Each rod is exactly 0.1 m long: 0.08 along, 0.06 down.
  for (std::uint32_t i = 0; i <= rods; ++i) {
    const double down = 0.06 * (i <= middle ? i : rods - i);
    scene.particles.push_back({.position = {0.08 * i, -down, 0}, .mass = 1, .fixed = i == 0 || i == rods});
    if (i > 0) scene.rods.push_back({.a = i - 1, .b = i, .length = 0.1});
  }

  plumb::World world(scene, {.substeps = 16});
  for (int frame = 0; frame < 20 * 60; ++frame) world.step(1.0 / 60);
  std::printf("the bridge sags by %.2f m\n", -world.position(middle).y);
}
