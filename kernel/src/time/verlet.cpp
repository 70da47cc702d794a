#include "time/verlet.hpp"

#include <algorithm>
#include <cmath>

#include "math/elementary.hpp"

namespace plumb::detail {

double mean_decay(double z) {
  return std::abs(z) > 1e-8 ? -detail::expm1(-z) / z : 1 - z / 2;
}

namespace {

/// Returns c h, no more than 50. Less than e^-50 of a velocity is nothing, and a larger exponent would
/// overflow e^(c h) at the start.
double drag_exponent(double drag, double h) {
  return std::min(drag * h, 50.0);
}

}  // namespace

double Verlet::decay(double h) const {
  return detail::exp(-drag_exponent(drag, h) * (gradient == Gradient::mid ? 0.5 : 1));
}

Vec3 Verlet::kick(Vec3 acceleration, double h) const {
  const double factor = gradient == Gradient::mid ? 0.5 : mean_decay(drag * h);
  return factor * h * h * acceleration;
}

Verlet::Displacements Verlet::start(Vec3 velocity, Vec3 acceleration, double h) const {
  if (gradient == Gradient::mid) return {h * velocity, {}};
  // The exact solution of v' = a - c v has this first displacement. The prediction is solved for the input
  // that leads to it.
  const double z = drag * h;
  const double phi = mean_decay(z);
  const double psi = z > 1e-4 ? (1 - phi) / z : 0.5 - z / 6;
  const Vec3 first = (h * phi) * velocity + (h * h * psi) * acceleration;
  const Vec3 last = detail::exp(drag_exponent(drag, h)) * (first - (phi * h * h) * acceleration);
  return {last, last - (h * h) * acceleration};
}

Vec3 Verlet::change_step(Vec3 last, Vec3 acceleration, double h, double next) const {
  const Vec3 mean = (1 / h) * last;
  if (gradient == Gradient::mid) return next * mean;
  // Force, gravity and drag take the velocity from the middle of the last substep to its new place. Rods do
  // not, because they act anew in the next solve. Extrapolating their pull too would be of first order.
  const Vec3 rate = acceleration - drag * mean;
  return next * mean + (0.5 * next * (h - next)) * rate;
}

Verlet::Displacements Verlet::change_acceleration(Displacements displacements, Vec3 change) const {
  if (gradient == Gradient::mid) return displacements;
  return {displacements.last - 0.5 * change, displacements.before - 1.5 * change};
}

}  // namespace plumb::detail
