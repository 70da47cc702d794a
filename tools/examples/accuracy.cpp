// Ask for an accuracy instead of substeps. The error grows by no more than this share of the scene's size a
// second, and plumb takes as many substeps as that needs.
#include <cmath>
#include <cstdint>
#include <cstdio>
#include <plumb/plumb.hpp>

namespace {

struct Run {
  plumb::Vec3 tip;
  std::uint64_t substeps = 0;
};

Run run(const plumb::Scene& scene, double accuracy) {
  // Methods direct and automatic know accuracies; relaxation knows none.
  plumb::World world(scene, {.method = plumb::Method::automatic, .accuracy = accuracy});
  Run out;
  for (int frame = 0; frame < 60; ++frame) out.substeps += world.step(1.0 / 60).direct_substeps;
  out.tip = world.position(world.particle_count() - 1);
  return out;
}

}  // namespace

int main() {
  plumb::Scene scene;
  scene.particles.push_back({.fixed = true});
  for (std::uint32_t i = 1; i <= 20; ++i) {
    scene.particles.push_back({.position = {0.1 * i, 0, 0}, .mass = i < 20 ? 1.0 : 10.0});
    scene.rods.push_back({.a = i - 1, .b = i});
  }

  const Run finest = run(scene, 1e-7);
  for (const double accuracy : {1e-2, 1e-3, 1e-4}) {
    const Run coarse = run(scene, accuracy);
    const double error = norm(coarse.tip - finest.tip) / plumb::bounding_diagonal(scene);
    std::printf("accuracy %g: %llu substeps, tip off by %.1e of the chain: %s\n", accuracy,
                static_cast<unsigned long long>(coarse.substeps), error,
                error <= 10 * accuracy ? "as asked" : "missed");
  }
}
