// A crane lowers a weight on a rope, lets it swing, and hauls it in again. The rope has mass: its particles
// come out of the drum and go back, and the drum holds what they bring.
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <plumb/plumb.hpp>

int main() {
  constexpr unsigned rods = 40;
  constexpr double length = 0.25, least = 1;  // m
  plumb::Scene scene;
  scene.drag = 0.2;
  scene.particles = {{.position = {0, 0, 0}, .fixed = true}};  // the drum, with most of the rope
  plumb::Reel reel{.particles = {0}, .out = least};
  for (unsigned i = 1; i <= rods; ++i) {
    const double out = std::max(0.0, least - (rods - i) * length);
    scene.particles.push_back({.position = {0.28 * out, -0.96 * out, 0}, .mass = i < rods ? 0.5 : 100});
    scene.rods.push_back({.a = i - 1, .b = i, .length = length});
    reel.particles.push_back(i);
  }
  scene.reels = {reel};
  plumb::World world(scene, {.substeps = 2, .tensions = true});
  double lowest = 0, most = 0;
  for (int frame = 1; frame <= 1200; ++frame) {
    const double s = 1 - std::abs(frame / 600.0 - 1);  // there in ten seconds, and back
    world.set_reel(0, least + (rods * length - least) * s * s * (3 - 2 * s));
    world.step(1.0 / 60);
    lowest = std::min(lowest, world.position(rods).y);
    most = std::max(most, plumb::norm(world.reaction(0)));
  }
  std::printf("the weight was %.1f m down, and the drum held up to %.0f N; %.2f m are out\n", -lowest, most,
              world.reel_out(0));
}
