// A winch lifts a load with a block of two sheaves. The load hangs from four falls of the cord, so the winch
// pulls with a quarter of its weight and hauls in four times as much as the load rises.
#include <cstdio>
#include <plumb/plumb.hpp>

int main() {
  plumb::Scene scene;
  scene.drag = 0.5;
  scene.particles = {{.position = {-0.2, 0, 0}, .fixed = true},  // where the cord ends
                     {.position = {0.2, 0, 0}, .fixed = true},   // a sheave at the ceiling
                     {.position = {0, -3, 0}, .mass = 100},      // the block, with the load
                     {.position = {2, -3, 0}, .fixed = true}};   // the winch
  scene.tackles = {{.particles = {0, 2, 1, 2, 1, 3}}};
  plumb::World world(scene, {.tensions = true});
  const double length = plumb::tackle_length(scene, 0);
  for (int frame = 0; frame < 600; ++frame) {
    const double s = (frame + 1) / 600.0;
    world.set_tackle_length(0, length - 4 * s * s * (3 - 2 * s));  // smoothly, in ten seconds
    world.step(1.0 / 60);
  }
  std::printf("the load rose by %.1f m; the cord pulls %.0f N, and the ceiling holds %.0f N\n",
              world.position(2).y + 3, world.tackle_tension(0), world.reaction(0).y + world.reaction(1).y);
}
