// What cannot be simulated is refused before anything changes, with the number of what is wrong and the
// reason.
#include <cstdio>
#include <plumb/plumb.hpp>

int main() {
  plumb::Scene scene;
  scene.particles = {{.fixed = true}, {.position = {1, 0, 0}, .mass = -1}};
  scene.rods = {{.a = 0, .b = 1}};
  try {
    const plumb::World world(scene);
  } catch (const plumb::InputError& error) {
    std::printf("refused: %s\n", error.what());
  }

  scene.particles[1].mass = 1;
  plumb::World world(scene);
  try {
    world.step(-1);
  } catch (const plumb::InputError& error) {
    std::printf("refused: %s; the world is still at %.0f s\n", error.what(), world.time());
  }
}
