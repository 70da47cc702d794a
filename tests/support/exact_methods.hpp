#pragma once

#include <cmath>
#include <cstdint>
#include <vector>

#include "plumb/plumb.hpp"
#include "support/worlds.hpp"

/// What tests of methods multipliers and featherstone share: both solve the same equations of motion exactly,
/// in other coordinates.
namespace plumb::test {

inline Settings exact(Method method, Integrator integrator = Integrator::rk4, std::uint32_t substeps = 1,
                      MassModel mass = MassModel::consistent) {
  return {.method = method, .mass = mass, .substeps = substeps, .integrator = integrator, .threads = 1};
}

inline Settings multipliers(Stabilization stabilization, Integrator integrator = Integrator::rk4,
                            std::uint32_t substeps = 1) {
  Settings settings = exact(Method::multipliers, integrator, substeps);
  settings.multipliers.stabilization = stabilization;
  return settings;
}

inline Frame frame_of(const World& world) {
  return {world.time(), positions_of(world), velocities_of(world)};
}

}  // namespace plumb::test
