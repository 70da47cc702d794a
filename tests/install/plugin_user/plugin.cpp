// A plugin that steps a world, whether plumb is in it or beside it.
#include <plumb/plumb.hpp>

extern "C" __attribute__((visibility("default"))) double fall_for(double dt) {
  plumb::Scene scene;
  scene.particles = {{.position = {0, 0, 0}, .velocity = {}, .mass = 1}};
  plumb::World world(scene);
  world.step(dt);
  return world.position(0).y;
}
