#pragma once

#include <memory>

#include "contest/stepper.hpp"
#include "plumb/world.hpp"

namespace plumb::bench {

/// plumb, through the interface that everybody uses.
class WorldStepper final : public Stepper {
 public:
  WorldStepper(const Scene& scene, const Settings& settings) : world_(scene, settings) {}

  /// Throws CheckFailed if a step projected another number of rods than it was asked to.
  double run(std::uint32_t steps, std::uint32_t sweeps) override;
  Stretch stretch(const Scene& scene) const override;
  const World& world() const { return world_; }

 private:
  World world_;
  std::uint32_t sweeps_ = 0;
};

/// Bytes that one sweep must move per rod if it is a pass of its own over memory: displacements read and
/// written once per particle, the rod's own numbers and addresses read.
double sweep_bytes_per_rod(const WorldInfo& info, Precision precision);

}  // namespace plumb::bench
