// Two walkers cross a rope bridge. A load lets them weigh where they are, between two ends of a plank.
#include <algorithm>
#include <cmath>
#include <cstdint>
#include <cstdio>
#include <plumb/plumb.hpp>
#include <span>

namespace {

constexpr std::uint32_t planks = 20;
constexpr double plank = 0.5, gravity = 9.81, walker = 80;  // m, m/s^2, kg

/// Returns where on the bridge a walker is who sets out at `start` (s) and makes 1.5 m/s, in planks.
double way(double time, double start) {
  return 1.5 * (time - start) / plank;
}

}  // namespace

int main() {
  plumb::Scene scene;  // planks that hang between two cliffs, at first in a V
  for (std::uint32_t i = 0; i <= planks; ++i) {
    const double from_end = std::min(i, planks - i);
    scene.particles.push_back({.position = {0.475 * i, -0.15 * from_end, 0}});
    if (i > 0) scene.rods.push_back({.a = i - 1, .b = i, .length = plank, .mass = 15});
  }
  scene.particles.front().fixed = scene.particles.back().fixed = true;
  scene.drag = 0.8;
  plumb::World world(scene, {.substeps = 4, .tensions = true});

  constexpr double first = 20, second = 22;  // s, when they set out
  world.set_load([&](const plumb::LoadState& state, std::span<plumb::Vec3> forces) {
    for (const double start : {first, second}) {
      const double at = way(state.time, start);
      if (at <= 0 || at >= planks) continue;
      const auto i = static_cast<std::uint32_t>(at);
      // A step lands twice a second, with a third of the weight more.
      const double weight = walker * gravity * (1 + 0.3 * std::sin(4 * 3.14159265 * state.time));
      plumb::add_force({{i, i + 1}, {1 - (at - i), at - i}}, {0, -weight, 0}, forces);
    }
  });
  const auto sag = [&] {
    double lowest = 0;
    for (std::uint32_t i = 0; i <= planks; ++i) lowest = std::min(lowest, world.position(i).y);
    return -lowest;
  };
  while (world.time() < first) world.step(1.0 / 60);
  std::printf("empty, the bridge sags by %.2f m; ", sag());
  double deepest = 0, held = 0;
  int frames = 0;
  while (world.time() < second + planks * plank / 1.5) {
    world.step(1.0 / 60);
    deepest = std::max(deepest, sag());
    if (way(world.time(), second) < 2 || way(world.time(), first) > planks - 2) continue;
    held += world.reaction(0).y + world.reaction(planks).y;  // both are on it
    ++frames;
  }
  std::printf("with walkers by up to %.2f m; its ends hold %.0f N, and all weighs %.0f N\n", deepest,
              held / frames, (2 * walker + planks * 15) * gravity);
}
