// An elastic rope hauls a load up. Then its weakest rod breaks.
#include <cstdio>
#include <plumb/plumb.hpp>

int main() {
  plumb::Scene scene;
  scene.drag = 0.5;
  for (unsigned i = 0; i <= 10; ++i) {
    scene.particles.push_back({.position = {0, -1.0 * i, 0}, .mass = i < 10 ? 0.2 : 50, .fixed = i == 0});
    if (i > 0) scene.rods.push_back({.a = i - 1, .b = i, .law = {.stiffness = 1e5, .damping = 200}});
  }
  scene.rods[4].law.strength = 1500;  // newtons
  plumb::World world(scene, {.tensions = true});
  for (int frame = 0; frame < 300; ++frame) {
    const double s = (frame + 1) / 300.0, hauled = 0.8 * s * s * (3 - 2 * s);  // smoothly, in five seconds
    for (unsigned rod = 0; rod < 10; ++rod) world.set_length(rod, 1 - hauled);
    world.step(1.0 / 60);
  }
  std::printf("load at %.1f m, pull at the top %.0f N\n", world.position(10).y, world.tension(0));
  world.set_force(10, {0, -1500, 0});
  for (int frame = 0; frame < 60; ++frame) world.step(1.0 / 60);
  std::printf("rod 4 %s\n", world.is_broken(4) ? "broke" : "holds");
}
