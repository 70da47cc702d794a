// The figure in plumb.
#include <chrono>
#include <stdexcept>

#include "plumb/joints.hpp"
#include "plumb/plumb.hpp"
#include "run.hpp"

namespace plumb::bench {
namespace {

Outcome run(const Scene& scene, const Settings& settings, std::uint32_t steps) {
  World world(scene, settings);
  StepReport report;
  const auto before = std::chrono::steady_clock::now();
  for (std::uint32_t step = 0; step < steps; ++step) report += world.step(duration / steps);
  Outcome out;
  out.ms = std::chrono::duration<double, std::milli>(std::chrono::steady_clock::now() - before).count();
  if (report.unsolved > 0 || report.frozen_islands > 0) throw std::runtime_error("plumb: not solved");
  for (std::uint32_t i = 0; i < scene.bodies.size(); ++i) {
    const Point center = point_on_body(scene, i, scene.bodies[i].center);
    Vec3 sum{};
    for (std::size_t k = 0; k < 4; ++k) sum += center.weights[k] * world.position(center.particles[k]);
    out.centers.push_back(sum);
  }
  return out;
}

}  // namespace

Outcome run_plumb(const Scene& scene, std::uint32_t time_order, std::uint32_t steps) {
  return run(scene,
             {.method = Method::direct, .gradient = Gradient::old, .time_order = time_order, .threads = 1},
             steps);
}

Outcome run_plumb_to_accuracy(const Scene& scene, double accuracy) {
  return run(scene, {.method = Method::automatic, .accuracy = accuracy, .threads = 1},
             static_cast<std::uint32_t>(30 * duration));
}

}  // namespace plumb::bench
