#include "reference/mechanical_system.hpp"

#include <stdexcept>

#include "reference/featherstone/featherstone.hpp"
#include "reference/multipliers/multipliers.hpp"
#include "reference/springs/springs.hpp"

namespace plumb::detail {
namespace {

void find_slope(MechanicalSystem& system, const MechanicalState& state, const Drive& drive, double t,
                MechanicalSlope& slope) {
  system.rates(state, slope.q);
  system.accelerations(state, drive, t, slope.v);
}

void move(const MechanicalState& state, double h, const MechanicalSlope& slope, MechanicalState& to) {
  to.q = state.q + h * slope.q;
  to.v = state.v + h * slope.v;
}

}  // namespace

void integrate(Integrator integrator, MechanicalSystem& system, MechanicalState& state, const Drive& drive,
               double h) {
  auto& [k1, k2, k3, k4] = system.slopes_;
  MechanicalState& stage = system.stage_;
  switch (integrator) {
    case Integrator::explicit_euler:
      find_slope(system, state, drive, 0, k1);
      move(state, h, k1, state);
      break;
    case Integrator::semi_implicit_euler:
      system.accelerations(state, drive, 0, k1.v);
      state.v += h * k1.v;
      system.rates(state, k1.q);
      state.q += h * k1.q;
      break;
    case Integrator::rk2:
      find_slope(system, state, drive, 0, k1);
      move(state, h / 2, k1, stage);
      find_slope(system, stage, drive, h / 2, k2);
      move(state, h, k2, state);
      break;
    case Integrator::rk4:
      find_slope(system, state, drive, 0, k1);
      move(state, h / 2, k1, stage);
      find_slope(system, stage, drive, h / 2, k2);
      move(state, h / 2, k2, stage);
      find_slope(system, stage, drive, h / 2, k3);
      move(state, h, k3, stage);
      find_slope(system, stage, drive, h, k4);
      state.q += h / 6 * (k1.q + 2 * k2.q + 2 * k3.q + k4.q);
      state.v += h / 6 * (k1.v + 2 * k2.v + 2 * k3.v + k4.v);
      break;
    case Integrator::implicit_euler:
    case Integrator::adaptive_implicit_euler:
      throw std::logic_error("integrate: an implicit step needs the system's own derivatives");
  }
  system.settle(state, drive, h);
}

void MechanicalSystem::advance(MechanicalState& state, const Drive& drive, double h) {
  integrate(integrator_, *this, state, drive, h);
}

std::unique_ptr<MechanicalSystem> make_system(const Scene& island, const Settings& settings,
                                              const IslandNames& names) {
  if (settings.method == Method::springs) return make_springs(island, settings);
  if (settings.method == Method::multipliers) return make_multipliers(island, settings);
  return make_featherstone(island, settings, names);
}

}  // namespace plumb::detail
