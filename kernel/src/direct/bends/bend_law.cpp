#include "direct/bends/bend_law.hpp"

#include <algorithm>
#include <cmath>

#include "scene/bends/curvature.hpp"

namespace plumb::detail {
namespace {

/// Adds scale u v^T + diagonal 1 to a matrix.
void add(std::array<double, 9>& to, double diagonal, Vec3 u, Vec3 v) {
  const double a[3] = {u.x, u.y, u.z}, b[3] = {v.x, v.y, v.z};
  for (std::size_t i = 0; i < 3; ++i) {
    to[4 * i] += diagonal;
    for (std::size_t j = 0; j < 3; ++j) to[3 * i + j] += a[i] * b[j];
  }
}

/// A quotient and its derivative by q1.
struct Quotient {
  double value, slope;
};

/// Returns g''(q).
double second_slope(double q) {
  return q < folded ? 0.5 * curvature_slope(q) / (1 - q / 4) : 0;
}

/// Returns (g(q1) - g(q0))/(q1 - q0) without cancellation: with a = 1/(1 - q/4) it is a0 a1.
Quotient slope_between(double q0, double q1) {
  if (q0 < folded && q1 < folded) {
    const double a0 = 1 / (1 - q0 / 4), a1 = 1 / (1 - q1 / 4);
    return {a0 * a1, a0 * a1 * a1 / 4};
  }
  if (q0 >= folded && q1 >= folded) return {folded_slope, 0};
  const double change = q1 - q0;
  const double value = std::min((squared_curvature(q1) - squared_curvature(q0)) / change, folded_slope);
  return {value, (curvature_slope(q1) - value) / change};
}

/// Returns w1 g'(q1)/kappa1, the derivative of kappa by w. A straight bend has none.
Vec3 curvature_gradient(Vec3 end, double q, double curvature) {
  return curvature > 0 ? curvature_slope(q) / curvature * end : Vec3{};
}

/// Adds damping (see bend_pull()): D w s/m f with w at theta, s = w . change, m = w.w + no_bend_direction
/// change.change and f = 1/(1 - q/4), the square of d phi/d|w|.
void add_damping(double damping, double theta, Vec3 start, Vec3 change, BendPull& out) {
  const Vec3 w = start + theta * change;
  const double q = dot(w, w), s = dot(w, change), m = q + no_bend_direction * dot(change, change);
  if (m == 0) return add(out.slope, damping * theta * theta / (theta * theta + no_bend_direction), {}, {});
  const bool is_folded = q >= folded;
  const double f = 1 / (1 - (is_folded ? folded : q) / 4), share = s / m;
  out.pull += damping * f * share * w;
  const Vec3 of_share =
      1 / m * (theta * change + w - share * (2 * theta * w + 2 * no_bend_direction * change));
  const Vec3 of_f = is_folded ? Vec3{} : 0.5 * f * theta * w;
  add(out.slope, damping * f * share * theta, damping * f * w, of_share + share * of_f);
}

}  // namespace

BendPull bend_pull(const BendNumbers& bend, const BendFactors& factors, Vec3 start, Vec3 change) {
  const bool is_mid = factors.theta < 1;
  const Vec3 end = start + change, first = is_mid ? start : end;
  const double q0 = dot(first, first), q1 = dot(end, end);
  const double half = 0.5 * factors.kick * bend.stiffness;
  Quotient between = is_mid ? slope_between(q0, q1) : Quotient{curvature_slope(q1), second_slope(q1)};
  Vec3 gradient = 2 * between.slope * end;
  if (bend.curvature > 0) {
    // With E = k/2 (kappa - rest)^2 the quotient is that of g times 1 - 2 rest/(kappa0 + kappa1).
    const double curvature = std::sqrt(squared_curvature(q1));
    const double sum = is_mid ? std::sqrt(squared_curvature(q0)) + curvature : 2 * curvature;
    const double share = sum > 0 ? 2 * bend.curvature / sum : 0;
    const double rate = sum > 0 ? (is_mid ? 1 : 2) * between.value * share / sum : 0;
    gradient = (1 - share) * gradient + rate * curvature_gradient(end, q1, curvature);
    between.value *= 1 - share;
  }
  const Vec3 both = first + end;
  BendPull out{half * between.value * both, {}};
  add(out.slope, half * between.value * (is_mid ? 1 : 2), half * both, gradient);
  if (bend.damping > 0) add_damping(factors.damping * bend.damping, factors.theta, start, change, out);
  return out;
}

BendPull definite_bend_pull(const BendNumbers& bend, double kick, Vec3 end) {
  BendNumbers undamped = bend;
  undamped.damping = 0;
  BendPull out = bend_pull(undamped, {kick, 0, 1}, {}, end);
  const double q = dot(end, end), curvature = std::sqrt(squared_curvature(q));
  if (curvature >= bend.curvature) return out;
  out.slope = {};
  const Vec3 along = curvature_gradient(end, q, curvature);
  add(out.slope, 0, kick * bend.stiffness * along, along);
  return out;
}

}  // namespace plumb::detail
