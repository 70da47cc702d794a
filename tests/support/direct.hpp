#pragma once

#include <algorithm>
#include <cmath>
#include <vector>

#include "plumb/plumb.hpp"
#include "support/worlds.hpp"

/// What tests of method direct share.
namespace plumb::test {

inline Settings direct(Gradient gradient, std::uint32_t substeps = 1,
                       MassModel mass = MassModel::consistent) {
  return {.method = Method::direct, .gradient = gradient, .mass = mass, .substeps = substeps, .threads = 1};
}

inline double energy_of(const Scene& scene, const World& world, MassModel mass) {
  return measure_energy(scene, positions_of(world), velocities_of(world), mass).total();
}

/// The worst of every step of a run.
struct Kept {
  double drift = 0;   ///< of energy, relative to the range
  double strain = 0;  ///< largest of a rod
  StepReport report{};
};
inline Kept run_and_watch(const Scene& scene, World& world, int steps, double dt = 1.0 / 60,
                          MassModel mass = MassModel::consistent) {
  Kept kept;
  const double before = energy_of(scene, world, mass);
  const double range = energy_range(scene) > 0 ? energy_range(scene) : before;
  for (int i = 0; i < steps; ++i) {
    kept.report += world.step(dt);
    kept.drift = std::max(kept.drift, std::abs(energy_of(scene, world, mass) - before) / range);
    kept.strain = std::max(kept.strain, stretch_of(scene, world).max);
  }
  return kept;
}

}  // namespace plumb::test
