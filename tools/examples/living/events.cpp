// Events say what became of islands: a rope comes to rest, is pulled until it breaks, and what is left rests
// again.
#include <cstdio>
#include <plumb/plumb.hpp>

int main() {
  plumb::Scene scene;
  scene.drag = 3;
  constexpr int links = 10;
  for (int i = 0; i <= links; ++i) {
    const auto end = static_cast<std::uint32_t>(i);
    scene.particles.push_back({.position = {0.02 * i, -0.1 * i, 0}, .mass = 0.1, .fixed = i == 0});
    if (i > 0) scene.rods.push_back({.a = end - 1, .b = end});
  }
  scene.rods[4].law.strength = 20;  // N
  plumb::World world(scene, {.events = true});

  bool was_pulled = false;
  for (int frame = 0; frame < 6000; ++frame) {
    world.step(1.0 / 60);
    for (const plumb::Event& event : world.events()) {
      if (event.kind == plumb::Event::Kind::broke)
        std::printf("rod %u broke at more than %.0f N; ", event.rod, event.strength);
      if (event.kind == plumb::Event::Kind::woke) std::printf("the rope woke; ");
      if (event.kind != plumb::Event::Kind::fell_asleep) continue;
      std::printf("the rope of particle %u fell asleep%s", event.particle, was_pulled ? "\n" : "; ");
      if (was_pulled) return 0;
      world.set_force(links, {0, -30, 0});
      was_pulled = true;
    }
  }
}
