// How wrong is it? Energy, strain and momentum are measured from outside, for any method.
#include <algorithm>
#include <cmath>
#include <cstdint>
#include <cstdio>
#include <plumb/plumb.hpp>
#include <vector>

int main() {
  plumb::Scene scene;
  scene.particles.push_back({.fixed = true});
  for (std::uint32_t i = 1; i <= 20; ++i) {
    scene.particles.push_back({.position = {0.1 * i, 0, 0}, .mass = i < 20 ? 1.0 : 100.0});
    scene.rods.push_back({.a = i - 1, .b = i});
  }
  // Direct solves with gradient mid keep energy and lengths to rounding, in steps of any length.
  plumb::World world(scene, {.method = plumb::Method::direct, .gradient = plumb::Gradient::mid});

  std::vector<plumb::Vec3> positions(world.particle_count()), velocities(world.particle_count());
  const auto energy = [&] {
    world.copy_positions(positions);
    world.copy_velocities(velocities);
    return plumb::measure_energy(scene, positions, velocities).total();
  };
  const double at_first = energy();
  double drift = 0, strain = 0;
  for (int frame = 0; frame < 10 * 60; ++frame) {
    world.step(1.0 / 60);
    drift = std::max(drift, std::abs(energy() - at_first) / plumb::energy_range(scene));
    strain = std::max(strain, plumb::measure_stretch(scene, positions).max);
  }
  std::printf("in 10 s: energy kept to 1e-10 of its range: %s; rods to 1e-12 of their length: %s\n",
              drift < 1e-10 ? "yes" : "no", strain < 1e-12 ? "yes" : "no");
}
