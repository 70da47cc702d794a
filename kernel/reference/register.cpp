#include "plumb/reference/methods.hpp"
#include "reference/reference_solver.hpp"
#include "scene/refuse.hpp"
#include "step/methods.hpp"

namespace plumb {
namespace {

using detail::refuse;

void validate_springs(const Settings& settings) {
  const bool adapts = integrator_of(settings) == Integrator::adaptive_implicit_euler;
  if (adapts && !settings.accuracy) refuse("integrator adaptive-implicit-euler needs an accuracy");
  if (!adapts && settings.accuracy)
    refuse("method springs takes an accuracy with integrator adaptive-implicit-euler alone");
}

void validate_explicit(const Settings& settings) {
  const Integrator integrator = integrator_of(settings);
  if (integrator == Integrator::implicit_euler || integrator == Integrator::adaptive_implicit_euler)
    refuse("integrator ", to_string(integrator), " needs method springs");
}

}  // namespace

void register_reference_methods() {
  using detail::Reads;
  detail::register_method(
      {.method = Method::springs,
       .name = to_string(Method::springs),
       .moves = "particles and rods, as rigid bodies or particles on stiff springs (thesis 3.3)",
       .reads = Reads::mass | Reads::integrator | Reads::accuracy | Reads::springs | Reads::stiffness |
                Reads::damping_ratio,
       .validate = validate_springs,
       .make = detail::make_reference_solvers});
  detail::register_method(
      {.method = Method::multipliers,
       .name = to_string(Method::multipliers),
       .moves = "particles, rods, bodies and joints, by Lagrange multipliers (thesis 3.4)",
       .reads = Reads::mass | Reads::integrator | Reads::stabilization | Reads::baumgarte_rate,
       .validate = validate_explicit,
       .make = detail::make_reference_solvers,
       .make_jointed = detail::make_jointed_solver});
  detail::register_method({.method = Method::featherstone,
                           .name = to_string(Method::featherstone),
                           .moves = "trees of rods or bodies that hang from one point or float (thesis 3.5)",
                           .reads = Reads::mass | Reads::integrator,
                           .validate = validate_explicit,
                           .make = detail::make_reference_solvers,
                           .make_jointed = detail::make_jointed_solver});
}

}  // namespace plumb
