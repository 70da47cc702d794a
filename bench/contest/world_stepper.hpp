#pragma once

#include <memory>

#include "contest/stepper.hpp"
#include "plumb/world.hpp"

namespace plumb::bench {

/// Steps plumb through the interface that everybody uses.
class WorldStepper final : public Stepper {
 public:
  WorldStepper(const Scene& scene, const Settings& settings) : world_(scene, settings) {}

  /// Makes steps as Stepper says. Throws CheckFailed if a step projected another number of rods than it was
  /// asked to.
  double run(std::uint32_t steps, std::uint32_t sweeps) override;
  Stretch stretch(const Scene& scene) const override;
  const World& world() const { return world_; }

 private:
  World world_;
  std::uint32_t sweeps_ = 0;
};

/// Returns the bytes that one sweep must move per rod if it is a pass of its own over memory. Displacements
/// are read and written once per particle, the rod's own numbers and addresses are read.
double sweep_bytes_per_rod(const WorldInfo& info, Precision precision);

}  // namespace plumb::bench
