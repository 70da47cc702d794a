#include "plumb/reference/methods.hpp"
#include "reference/reference_solver.hpp"
#include "step/methods.hpp"

namespace plumb {

void register_reference_methods() {
  using detail::Reads;
  detail::register_method(
      {.method = Method::springs,
       .name = "springs",
       .moves = "particles and rods, as rigid bodies or particles on stiff springs (thesis 3.3)",
       .reads = Reads::mass | Reads::integrator | Reads::springs | Reads::accuracy,
       .make = detail::make_reference_solvers});
  detail::register_method({.method = Method::multipliers,
                           .name = "multipliers",
                           .moves = "particles and rods, by Lagrange multipliers (thesis 3.4)",
                           .reads = Reads::mass | Reads::integrator | Reads::multipliers,
                           .make = detail::make_reference_solvers});
  detail::register_method({.method = Method::featherstone,
                           .name = "featherstone",
                           .moves = "trees of rods that hang from one point or float (thesis 3.5)",
                           .reads = Reads::mass | Reads::integrator,
                           .make = detail::make_reference_solvers});
}

}  // namespace plumb
