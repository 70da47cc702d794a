// A net hangs from its two upper corners: every particle is tied to its neighbours to the right and
// below.
#include <cstdint>
#include <cstdio>
#include <plumb/plumb.hpp>

int main() {
  constexpr std::uint32_t side = 12;
  plumb::Scene scene;
  scene.drag = 1;
  for (std::uint32_t row = 0; row < side; ++row)
    for (std::uint32_t column = 0; column < side; ++column) {
      const std::uint32_t here = row * side + column;
      // The anchors stand closer than the net is wide, so that its upper edge sags.
      scene.particles.push_back({.position = {0.09 * column, 0, 0.1 * row},
                                 .mass = 0.01,
                                 .fixed = row == 0 && (column == 0 || column == side - 1)});
      if (column + 1 < side) scene.rods.push_back({.a = here, .b = here + 1, .length = 0.1});
      if (row + 1 < side) scene.rods.push_back({.a = here, .b = here + side, .length = 0.1});
    }

  plumb::World world(scene, {.method = plumb::Method::relax, .substeps = 8, .stop = {.sweeps = 50}});
  for (int frame = 0; frame < 10 * 60; ++frame) world.step(1.0 / 60);

  std::uint32_t lowest = 0;
  for (std::uint32_t i = 0; i < world.particle_count(); ++i)
    if (world.position(i).y < world.position(lowest).y) lowest = i;
  const plumb::WorldInfo& info = world.info();
  std::printf("%u rods in %u island; particle %u hangs lowest, in row %u of %u\n", info.rods, info.islands,
              lowest, lowest / side + 1, side);
}
