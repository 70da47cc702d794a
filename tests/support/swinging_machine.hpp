#pragma once

#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <numbers>

#include "plumb/plumb.hpp"
#include "support/worlds.hpp"

namespace plumb::test {

/// How the tests of tackles solve: directly, and with all tensions known.
inline Settings direct_with_tensions(Gradient gradient, std::uint32_t substeps = 1) {
  return {.method = Method::direct, .gradient = gradient, .substeps = substeps, .tensions = true};
}

/// What hangs on the cord of Atwood's machine.
struct AtwoodMasses {
  double first = 1, second = 1;  ///< kg
};
/// Two masses over a pulley at the origin. The second one hangs 1 m below, turned by `angle` (rad).
inline Scene atwood(const AtwoodMasses& masses, double friction = 0, double angle = 0) {
  Scene scene;
  scene.particles = {movable({0, -2, 0}, masses.first), fixed({}),
                     movable({std::sin(angle), -std::cos(angle), 0}, masses.second)};
  scene.tackles = {{.particles = {0, 1, 2}, .friction = friction}};
  return scene;
}

/// Where the second mass of a machine is after t (s), by the equations of the swinging Atwood machine
/// (Tufillaro 1984) and Runge and Kutta's method. The cord slides towards it. The pull behind the pulley is
/// e = exp(friction (pi - phi)) times that before it: (m + e M) r'' = m (r phi'^2 + g cos phi) - e M g, and
/// r phi'' = -2 r' phi' - g sin phi.
inline Vec3 swung(double first, double second, double friction, double angle, double t) {
  constexpr double g = 9.81;
  using Swing = std::array<double, 4>;  // r, phi and their rates
  const auto slope = [&](const Swing& s) {
    const auto [r, phi, r_rate, phi_rate] = s;
    const double ratio = std::exp(friction * (std::numbers::pi - std::abs(phi)));
    return Swing{r_rate, phi_rate,
                 (second * (r * phi_rate * phi_rate + g * std::cos(phi)) - ratio * first * g) /
                     (ratio * first + second),
                 (-2 * r_rate * phi_rate - g * std::sin(phi)) / r};
  };
  const auto moved = [](const Swing& s, double by, const Swing& rate) {
    Swing out = s;
    for (std::size_t i = 0; i < 4; ++i) out[i] += by * rate[i];
    return out;
  };
  Swing s{1, angle, 0, 0};
  constexpr int steps = 4000;
  const double h = t / steps;
  for (int i = 0; i < steps; ++i) {
    const Swing a = slope(s), b = slope(moved(s, h / 2, a)), c = slope(moved(s, h / 2, b)),
                d = slope(moved(s, h, c));
    for (std::size_t k = 0; k < 4; ++k) s[k] += h / 6 * (a[k] + 2 * b[k] + 2 * c[k] + d[k]);
  }
  return {s[0] * std::sin(s[1]), -s[0] * std::cos(s[1]), 0};
}

}  // namespace plumb::test
