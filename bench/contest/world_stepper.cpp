#include "contest/world_stepper.hpp"

#include <chrono>
#include <vector>

#include "support/check.hpp"

namespace plumb::bench {

double WorldStepper::run(std::uint32_t steps, std::uint32_t sweeps) {
  if (sweeps != sweeps_) {
    world_.set_stop_rule({.sweeps = sweeps});
    sweeps_ = sweeps;
  }
  StepReport report;
  const auto start = std::chrono::steady_clock::now();
  for (std::uint32_t i = 0; i < steps; ++i) report += world_.step(frame_length);
  const std::chrono::duration<double> seconds = std::chrono::steady_clock::now() - start;
  if (report.rod_projections != std::uint64_t{steps} * sweeps * world_.rod_count())
    throw CheckFailed("a step did not project every rod in every sweep");
  return seconds.count() / steps;
}

Stretch WorldStepper::stretch(const Scene& scene) const {
  std::vector<Vec3> positions(world_.particle_count());
  world_.copy_positions(positions);
  return measure_stretch(scene, positions);
}

double sweep_bytes_per_rod(const WorldInfo& info, Precision precision) {
  const double number = precision == Precision::single ? 4 : 8;
  double bytes = 0;
  for (const BlockInfo& block : info.blocks) {
    const double particle_numbers = block.layout == "aos" ? 4 : 3;
    const double rod_numbers = 4 + 3 * (1 - block.uniform_fraction);
    const double addresses =
        block.shape == "graph" ? 8 : 8 * number / 64;  // bytes of an address pair per rod or per vector
    bytes +=
        2 * number * particle_numbers * block.particles + (number * rod_numbers + addresses) * block.rods;
  }
  return bytes / info.rods;
}

}  // namespace plumb::bench
