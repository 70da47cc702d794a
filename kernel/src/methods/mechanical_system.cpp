#include "mechanical_system.hpp"

#include <stdexcept>
#include <string>

#include "plumb/error.hpp"
#include "springs.hpp"

namespace plumb::detail {
namespace {

using Eigen::VectorXd;

/// Rates of coordinates and velocities at one instant.
struct Slope {
  VectorXd q, v;
};

void find_slope(MechanicalSystem& system, const MechanicalState& state, const Drive& drive, double t,
                Slope& slope) {
  system.rates(state, slope.q);
  system.accelerations(state, drive, t, slope.v);
}

MechanicalState moved(const MechanicalState& state, double h, const Slope& slope) {
  return {state.q + h * slope.q, state.v + h * slope.v};
}

}  // namespace

void integrate(Integrator integrator, MechanicalSystem& system, MechanicalState& state, const Drive& drive,
               double h) {
  Slope k1;
  switch (integrator) {
    case Integrator::explicit_euler:
      find_slope(system, state, drive, 0, k1);
      state = moved(state, h, k1);
      break;
    case Integrator::semi_implicit_euler:
      system.accelerations(state, drive, 0, k1.v);
      state.v += h * k1.v;
      system.rates(state, k1.q);
      state.q += h * k1.q;
      break;
    case Integrator::rk2: {
      Slope k2;
      find_slope(system, state, drive, 0, k1);
      find_slope(system, moved(state, h / 2, k1), drive, h / 2, k2);
      state = moved(state, h, k2);
      break;
    }
    case Integrator::rk4: {
      Slope k2, k3, k4;
      find_slope(system, state, drive, 0, k1);
      find_slope(system, moved(state, h / 2, k1), drive, h / 2, k2);
      find_slope(system, moved(state, h / 2, k2), drive, h / 2, k3);
      find_slope(system, moved(state, h, k3), drive, h, k4);
      state = moved(state, h / 6, {k1.q + 2 * k2.q + 2 * k3.q + k4.q, k1.v + 2 * k2.v + 2 * k3.v + k4.v});
      break;
    }
    case Integrator::implicit_euler:
    case Integrator::adaptive_implicit_euler:
      throw std::logic_error("integrate: an implicit step needs the system's own derivatives");
  }
  system.settle(state, drive, h);
}

void MechanicalSystem::advance(MechanicalState& state, const Drive& drive, double h) {
  integrate(integrator_, *this, state, drive, h);
}

std::unique_ptr<MechanicalSystem> make_system(const Scene& island, const Settings& settings) {
  switch (settings.method) {
    case Method::springs:
      return make_springs(island, settings);
    default:
      throw NotBuiltError("method " + std::string(to_string(settings.method)) + " is not built yet");
  }
}

}  // namespace plumb::detail
