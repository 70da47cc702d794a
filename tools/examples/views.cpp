// A program reads a state one by one, as a view that copies nothing, or copied into an array of one's own.
#include <cstdint>
#include <cstdio>
#include <plumb/plumb.hpp>
#include <vector>

int main() {
  plumb::Scene scene;
  scene.particles.push_back({.fixed = true});
  for (std::uint32_t i = 1; i <= 10; ++i) {
    scene.particles.push_back({.position = {0.1 * i, 0, 0}, .mass = 1});
    scene.rods.push_back({.a = i - 1, .b = i});
  }
  plumb::World world(scene, {.substeps = 4});

  const plumb::StateView positions = world.positions(), velocities = world.velocities();
  std::vector<plumb::Vec3> copy(world.particle_count());
  for (int frame = 0; frame < 3; ++frame) world.step(1.0 / 60);
  world.copy_positions(copy);

  // The views were made before the steps, and show the state after them.
  int alike = 0, falling = 0;
  for (std::uint32_t i = 0; i < positions.size(); ++i) {
    alike += positions[i] == copy[i] && positions[i] == world.position(i);
    falling += velocities[i].y < 0;
  }
  std::printf("%d of %zu positions are alike in all three ways; %d particles fall\n", alike, positions.size(),
              falling);
}
