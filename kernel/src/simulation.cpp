#include "simulation.hpp"

#include "composite_simulation.hpp"
#include "direct_simulation.hpp"
#include "relax_simulation.hpp"

namespace plumb::detail {

std::unique_ptr<Simulation> make_simulation(const Scene& scene, const Settings& settings) {
  if (settings.method == Method::automatic) return make_composite_simulation(scene, settings);
  if (settings.method == Method::direct) return make_direct_simulation(scene, settings);
  if (settings.precision == Precision::single)
    return std::make_unique<RelaxSimulation<float>>(scene, settings);
  return std::make_unique<RelaxSimulation<double>>(scene, settings);
}

}  // namespace plumb::detail
