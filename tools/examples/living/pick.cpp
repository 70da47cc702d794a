// Queries say what is where: a ray from the eye picks a rope, and a ball tells whether there is room to go.
#include <cstdint>
#include <cstdio>
#include <plumb/plumb.hpp>

int main() {
  plumb::Scene scene;
  scene.drag = 1;
  for (std::uint32_t i = 0; i <= 20; ++i) {  // a rope that hangs from the ceiling, 3 m in front of the eye
    scene.particles.push_back({.position = {0.1 * i, 3, 3}, .mass = 0.1, .fixed = i == 0});
    if (i > 0) scene.rods.push_back({.a = i - 1, .b = i});
  }
  scene.planes = {{}};
  plumb::World world(scene);
  plumb::Queries queries(scene, {.rod_radius = 0.02});
  for (int frame = 0; frame < 600; ++frame) world.step(1.0 / 60);
  queries.update(world);  // after steps, before questions

  const plumb::Ray look{.origin = {0, 1.7, 0}, .direction = {0, 0, 1}};
  const plumb::Hit hit = queries.cast_ray(look);
  std::printf("rod %u is %.2f m in front of the eye; ", hit.target.number, hit.distance);

  // What is picked can be pushed: here at the end of the rod, for half a second.
  world.set_force(scene.rods[hit.target.number].b, {0, 0, 20});
  for (int frame = 0; frame < 30; ++frame) world.step(1.0 / 60);
  queries.update(world);
  std::printf("pushed, the rope is %s; ", queries.cast_ray(look) ? "there" : "away");

  const plumb::Ray walk{.origin = {0, 0.5, 0}, .direction = {0, 0, 1}, .length = 2};
  std::printf("a ball of 0.4 m has room to go: %s\n", queries.cast_sphere(walk, 0.4) ? "no" : "yes");
}
