// A pendulum by Lagrange multipliers, which World knows only once plumb::reference is registered.
#include <cmath>
#include <cstdio>
#include <plumb/plumb.hpp>
#include <plumb/reference/methods.hpp>

int main() {
  plumb::Scene scene;
  scene.particles.push_back({.position = {0, 0, 0}, .velocity = {}, .mass = 0, .fixed = true});
  scene.particles.push_back({.position = {1, 0, 0}, .velocity = {}, .mass = 1});
  scene.rods.push_back({.a = 0, .b = 1});
  const plumb::Settings settings{.method = plumb::Method::multipliers};
  try {
    const plumb::World too_early(scene, settings);
    return 1;
  } catch (const plumb::InputError& error) {
    std::printf("%s\n", error.what());
  }
  plumb::register_reference_methods();
  plumb::World world(scene, settings);
  world.step(0.1);
  return std::abs(plumb::norm(world.position(1)) - 1) < 1e-6 ? 0 : 2;
}
