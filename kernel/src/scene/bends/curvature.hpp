#pragma once

#include <algorithm>
#include <cmath>

// The energy of a bend (plumb::Bend) is that of one vector, w = d1/L1 - d2/L2, with d1 and d2 from a to b and
// from b to c, and L1 and L2 the rods' lengths. q = w.w is quadratic in positions. Rods at their lengths have
// q = 4 sin^2(phi/2), so that the square of the discrete curvature 2 tan(phi/2) is g(q) = q/(1 - q/4).
namespace plumb::detail {

/// Above this q, g goes on along its tangent. Newton's method and elastic rods come there.
inline constexpr double folded = 4 - 1.0 / 16;
inline constexpr double folded_slope = 4096;  ///< It is g' there: 1/(1 - q/4)^2.

/// Rods that are folded so far have this 1 + p . q, of tangents p and q. A twist (plumb::Twist) keeps it from
/// falling below.
inline constexpr double least_twist_sum = 1.0 / 32;

/// Beyond 165.6 degrees the law is a tangent, so steep that Newton's method finds no rest on it. In rad.
inline constexpr double largest_rest_angle = 2.89;

/// Where a damped bend passes the straight line, w has no direction. This share of the square of the change
/// is added to its square. Damping of an oscillator then is of second order; with 1e-2 it would be of first.
inline constexpr double no_bend_direction = 1e-6;

/// Returns g(q), the square of the discrete curvature.
inline double squared_curvature(double q) {
  return q < folded ? q / (1 - q / 4) : folded * 64 + folded_slope * (q - folded);
}
/// Returns g'(q).
inline double curvature_slope(double q) {
  return q < folded ? 1 / ((1 - q / 4) * (1 - q / 4)) : folded_slope;
}

/// Returns the curvature 2 tan(phi/2) for phi in [0, pi] rad. The C library's sine would depend on the
/// processor.
inline double curvature_of_angle(double phi) {
  const double x = phi / 2;
  double series = 1;
  for (int k = 27; k > 1; k -= 2) series = 1 - x * x / (k * (k - 1)) * series;
  const double sine = x * series;
  return std::sqrt(squared_curvature(4 * sine * sine));
}

/// Returns k/2 (kappa - rest)^2 at q.
inline double bending_energy(double stiffness, double rest, double q) {
  const double off = std::sqrt(squared_curvature(q)) - rest;
  return 0.5 * stiffness * off * off;
}

}  // namespace plumb::detail
