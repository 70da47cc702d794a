// A program may move an anchor: a hand carries a pendulum 3 m to the right, at 1 m/s.
#include <algorithm>
#include <cstdio>
#include <plumb/plumb.hpp>

int main() {
  plumb::Scene scene;
  scene.drag = 2;
  scene.particles = {{.position = {0, 0, 0}, .fixed = true}, {.position = {0, -1, 0}, .mass = 1}};
  scene.rods = {{.a = 0, .b = 1}};

  plumb::World world(scene, {.substeps = 8});
  for (int frame = 1; frame <= 15 * 60; ++frame) {
    // The anchor is there at the end of the next step, and moves on a straight line until then.
    world.move_anchor(0, {std::min(frame / 60.0, 3.0), 0, 0});
    world.step(1.0 / 60);
    if (frame == 60)
      std::printf("while the hand moves, the weight %s\n", world.position(1).x < 1 ? "trails" : "leads");
  }
  std::printf("at rest it hangs at x = %.2f m, y = %.2f m\n", world.position(1).x, world.position(1).y);
}
