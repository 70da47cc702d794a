// Weights matter where masses differ: a chain whose last particle is heavy moves otherwise than one that is
// light all over. Corrections by inverse mass show it. Equal corrections do not see the mass at all.
#include <cstdint>
#include <cstdio>
#include <plumb/plumb.hpp>

namespace {

plumb::Scene make_chain(double end_mass) {
  plumb::Scene scene;
  scene.particles.push_back({.fixed = true});
  for (std::uint32_t i = 1; i <= 5; ++i) {
    scene.particles.push_back({.position = {0.1 * i, 0, 0}, .mass = i < 5 ? 1.0 : end_mass});
    scene.rods.push_back({.a = i - 1, .b = i});
  }
  return scene;
}

plumb::Vec3 tip_after_a_second(double end_mass, plumb::Weights weights) {
  // Weights are a choice of relaxation alone: the other methods know mass in one way only.
  plumb::World world(
      make_chain(end_mass),
      {.method = plumb::Method::relax, .weights = weights, .substeps = 8, .stop = {.sweeps = 100}});
  for (int frame = 0; frame < 60; ++frame) world.step(1.0 / 60);
  return world.position(5);
}

}  // namespace

int main() {
  for (const plumb::Weights weights : {plumb::Weights::mass, plumb::Weights::equal}) {
    const plumb::Vec3 change = tip_after_a_second(10, weights) - tip_after_a_second(1, weights);
    std::printf("weights %s: a tenfold end mass moves the tip by %.3f m\n",
                weights == plumb::Weights::mass ? "by mass" : "equal", norm(change));
  }
}
