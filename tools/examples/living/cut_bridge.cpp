// Programs may change a world while it runs: a bridge is cut in the middle, and one half is hung elsewhere.
#include <cstdint>
#include <cstdio>
#include <numeric>
#include <plumb/plumb.hpp>
#include <vector>

int main() {
  plumb::Scene scene;
  scene.drag = 1;
  const std::uint32_t last = 40;
  for (std::uint32_t i = 0; i <= last; ++i) {
    scene.particles.push_back({.position = {0.1 * i, 0, 0}, .mass = 2, .fixed = i == 0 || i == last});
    if (i > 0) scene.rods.push_back({.a = i - 1, .b = i, .length = 0.102});
  }
  plumb::World world(scene);
  for (int frame = 0; frame < 300; ++frame) world.step(1.0 / 60);
  std::printf("the bridge hangs %.2f m deep; ", -world.position(last / 2).y);

  world.cut(last / 2);  // the rod behind the particle in the middle, from the next step on
  for (int frame = 0; frame < 900; ++frame) world.step(1.0 / 60);
  std::printf("cut, its left end hangs %.2f m deep; ", -world.position(last / 2).y);

  // All of the left half at once, its anchor included, so that nothing jerks.
  std::vector<std::uint32_t> half(last / 2 + 1);
  std::iota(half.begin(), half.end(), 0u);
  std::vector<plumb::Vec3> places, velocities(half.size());
  for (const std::uint32_t particle : half)
    places.push_back(world.position(particle) + plumb::Vec3{0, 100, 0});
  world.teleport(half, places, velocities);
  world.step(1.0 / 60);
  std::printf("hung 100 m higher, it moves at %.1f m/s\n", plumb::norm(world.velocity(last / 2)));
}
