#include "step/simulation.hpp"

#include "contact/linkage_simulation.hpp"
#include "direct/direct_simulation.hpp"
#include "reference/method_simulation.hpp"
#include "relax/relax_simulation.hpp"
#include "step/composite_simulation.hpp"

namespace plumb::detail {

std::unique_ptr<Simulation> make_simulation(const Scene& scene, const Settings& settings) {
  if (is_articulated(scene)) return make_linkage_simulation(scene, settings);
  switch (settings.method) {
    case Method::automatic:
      return make_composite_simulation(scene, settings);
    case Method::relax:
      if (settings.precision == Precision::single)
        return std::make_unique<RelaxSimulation<float>>(scene, settings);
      return std::make_unique<RelaxSimulation<double>>(scene, settings);
    case Method::direct:
      return make_direct_simulation(scene, settings);
    case Method::springs:
    case Method::multipliers:
    case Method::featherstone:
      break;
  }
  return make_method_simulation(scene, settings);
}

}  // namespace plumb::detail
