// A pendulum of 1 m let go from the side: after 0.1 s it has fallen about g t^2/2.
#include <cmath>
#include <cstdio>
#include <plumb/plumb.hpp>
#include <string>

int main() {
  plumb::Scene scene;
  scene.particles.push_back({.position = {0, 0, 0}, .velocity = {}, .mass = 0, .fixed = true});
  scene.particles.push_back({.position = {1, 0, 0}, .velocity = {}, .mass = 1});
  scene.rods.push_back({.a = 0, .b = 1});
  plumb::World world(scene, {.gradient = plumb::Gradient::old, .substeps = 8});
  for (int frame = 0; frame < 6; ++frame) world.step(1.0 / 60);
  const plumb::Vec3 tip = world.position(1);
  std::printf("%s: tip at %g %g\n", std::string(plumb::to_string(world.info().isa)).c_str(), tip.x, tip.y);
  const bool fell = std::abs(tip.y + 9.81 * 0.01 / 2) < 1e-3 && std::abs(plumb::norm(tip) - 1) < 1e-6;
  return fell ? 0 : 1;
}
