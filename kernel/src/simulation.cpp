#include "simulation.hpp"

#include "refuse.hpp"
#include "relax_simulation.hpp"

namespace plumb::detail {

std::unique_ptr<Simulation> make_simulation(const Scene& scene, const Settings& settings) {
  if (settings.isa && !is_supported(*settings.isa))
    refuse("instruction set ", to_string(*settings.isa), " is not supported by this machine");
  if (settings.precision == Precision::single)
    return std::make_unique<RelaxSimulation<float>>(scene, settings);
  return std::make_unique<RelaxSimulation<double>>(scene, settings);
}

}  // namespace plumb::detail
