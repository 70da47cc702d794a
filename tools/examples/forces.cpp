// A program may set a force on a particle: wind pushes a pendulum with as much force as its weight, so it
// leans by 45 degrees.
#include <cmath>
#include <cstdio>
#include <numbers>
#include <plumb/plumb.hpp>

int main() {
  plumb::Scene scene;
  scene.drag = 2;
  scene.particles = {{.position = {0, 0, 0}, .fixed = true}, {.position = {0, -1, 0}, .mass = 2}};
  scene.rods = {{.a = 0, .b = 1}};

  plumb::World world(scene, {.substeps = 8});
  const auto lean = [&] {
    for (int frame = 0; frame < 15 * 60; ++frame) world.step(1.0 / 60);
    return std::atan2(world.position(1).x, -world.position(1).y) * 180 / std::numbers::pi;
  };

  world.set_force(1, {2 * 9.81, 0, 0});  // The force is in N and stays until it is changed.
  const double windy = lean();
  world.set_force(1, {});
  std::printf("in the wind it leans by %.1f degrees, without by %.1f\n", windy, std::abs(lean()));
}
