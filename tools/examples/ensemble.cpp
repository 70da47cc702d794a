// Many equal things fit in one world: they lie side by side in the lanes of a vector, and every one of them
// moves as if it were alone.
#include <cstdint>
#include <cstdio>
#include <plumb/plumb.hpp>

namespace {

void add_chain(plumb::Scene& scene, double z) {
  const auto first = static_cast<std::uint32_t>(scene.particles.size());
  scene.particles.push_back({.position = {0, 0, z}, .fixed = true});
  for (std::uint32_t i = 1; i <= 10; ++i) {
    scene.particles.push_back({.position = {0.1 * i, 0, z}, .mass = 1});
    scene.rods.push_back({.a = first + i - 1, .b = first + i});
  }
}

}  // namespace

int main() {
  plumb::Scene one, many;
  add_chain(one, 0);
  for (int i = 0; i < 256; ++i) add_chain(many, i);

  plumb::World alone(one), crowd(many);
  for (int frame = 0; frame < 60; ++frame) {
    alone.step(1.0 / 60);
    crowd.step(1.0 / 60);
  }
  int alike = 0;
  for (std::uint32_t i = 0; i < 256; ++i) {
    const plumb::Vec3 tip = crowd.position(11 * i + 10), other = alone.position(10);
    alike += tip.x == other.x && tip.y == other.y;
  }
  std::printf("%u islands, %d of 256 tips move as if alone\n", crowd.info().islands, alike);
}
