#pragma once

#include <cstdint>
#include <memory>

#include "plumb/scene.hpp"
#include "plumb/settings.hpp"
#include "plumb/world.hpp"

namespace plumb::detail {

/// What moves the particles of a World, by one method and in one precision. Input is validated by the World;
/// particles have their numbers in the scene. Each kind fills what applies to it in StepReport and WorldInfo.
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

/// Of the kind that the settings ask for.
std::unique_ptr<Simulation> make_simulation(const Scene& scene, const Settings& settings);

}  // namespace plumb::detail
