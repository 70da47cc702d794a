#pragma once

#include <cstdint>
#include <memory>
#include <vector>

#include "block.hpp"
#include "plumb/executor.hpp"
#include "plumb/scene.hpp"
#include "plumb/settings.hpp"
#include "plumb/world.hpp"
#include "team.hpp"

namespace plumb::detail {

/// A World without its precision.
class Simulation {
 public:
  virtual ~Simulation() = default;
  virtual StepReport step(double dt) = 0;
  virtual void set_stop_rule(const StopRule& rule) = 0;
  virtual void set_weights(Weights weights) = 0;
  virtual void set_force(std::uint32_t particle, Vec3 force) = 0;
  virtual void move_anchor(std::uint32_t particle, Vec3 target) = 0;
  virtual Vec3 position(std::uint32_t particle) const = 0;
  virtual Vec3 velocity(std::uint32_t particle) const = 0;
  virtual std::uint64_t state_hash() const = 0;
  virtual const WorldInfo& info() const = 0;
};

std::unique_ptr<Simulation> make_simulation(const Scene& scene, const Settings& settings);

}  // namespace plumb::detail
