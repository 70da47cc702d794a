#pragma once

#include <array>
#include <cmath>
#include <cstddef>
#include <vector>

#include "plumb/measures.hpp"

namespace plumb::test {

/// Truth for short chains: point masses on massless rods in the x-y plane, hung from the origin, in the
/// angles of the rods from the +x axis. Angles have no constraints to drift from, so this shares nothing with
/// what it checks.
///
/// Lagrange: sum_j mu_max(i,j) L_i L_j [cos(t_i - t_j) t_j'' + sin(t_i - t_j) t_j'^2] = -mu_i g L_i cos(t_i),
/// where mu_k is the mass at and below joint k. Classical Runge-Kutta in long double: its error falls with
/// the fourth power of the step, and tests that use it check it against half the step.
template <std::size_t n>
class PlanarChain {
 public:
  using Number = long double;
  using Vector = std::array<Number, n>;

  PlanarChain(Vector masses, Number length, Number gravity) : length_(length), gravity_(gravity) {
    Number below = 0;
    for (std::size_t i = n; i-- > 0;) mass_below_[i] = below += masses[i];
  }

  Vector angles{};  ///< 0: along +x
  Vector rates{};   ///< 1/s

  void advance(Number duration, int steps) {
    const Number h = duration / steps;
    for (int i = 0; i < steps; ++i) {
      const State s{angles, rates};
      const State k1 = derivative(s), k2 = derivative(moved(s, h / 2, k1)),
                  k3 = derivative(moved(s, h / 2, k2)), k4 = derivative(moved(s, h, k3));
      for (std::size_t j = 0; j < n; ++j) {
        angles[j] += h / 6 * (k1.angles[j] + 2 * k2.angles[j] + 2 * k3.angles[j] + k4.angles[j]);
        rates[j] += h / 6 * (k1.rates[j] + 2 * k2.rates[j] + 2 * k3.rates[j] + k4.rates[j]);
      }
    }
  }

  /// Particle 0 is the anchor.
  Frame frame() const {
    Frame frame{0, {{}}, {{}}};
    Number x = 0, y = 0, vx = 0, vy = 0;
    for (std::size_t i = 0; i < n; ++i) {
      const Number c = length_ * std::cos(angles[i]), s = length_ * std::sin(angles[i]);
      x += c;
      y += s;
      vx -= s * rates[i];
      vy += c * rates[i];
      frame.positions.push_back({static_cast<double>(x), static_cast<double>(y), 0});
      frame.velocities.push_back({static_cast<double>(vx), static_cast<double>(vy), 0});
    }
    return frame;
  }

 private:
  struct State {
    Vector angles, rates;
  };

  static State moved(State s, Number h, const State& k) {
    for (std::size_t i = 0; i < n; ++i) {
      s.angles[i] += h * k.angles[i];
      s.rates[i] += h * k.rates[i];
    }
    return s;
  }

  State derivative(const State& s) const {
    std::array<std::array<Number, n + 1>, n> rows{};
    for (std::size_t i = 0; i < n; ++i) {
      rows[i][n] = -mass_below_[i] * gravity_ / length_ * std::cos(s.angles[i]);
      for (std::size_t j = 0; j < n; ++j) {
        const Number mass = mass_below_[i > j ? i : j], between = s.angles[i] - s.angles[j];
        rows[i][j] = mass * std::cos(between);
        rows[i][n] -= mass * std::sin(between) * s.rates[j] * s.rates[j];
      }
    }
    return {s.rates, solve(rows)};
  }

  /// Gauss without pivots: the matrix is symmetric positive definite.
  static Vector solve(std::array<std::array<Number, n + 1>, n>& rows) {
    for (std::size_t i = 0; i < n; ++i)
      for (std::size_t k = i + 1; k < n; ++k) {
        const Number factor = rows[k][i] / rows[i][i];
        for (std::size_t j = i; j <= n; ++j) rows[k][j] -= factor * rows[i][j];
      }
    Vector x{};
    for (std::size_t i = n; i-- > 0;) {
      x[i] = rows[i][n];
      for (std::size_t j = i + 1; j < n; ++j) x[i] -= rows[i][j] * x[j];
      x[i] /= rows[i][i];
    }
    return x;
  }

  Number length_, gravity_;
  Vector mass_below_{};
};

}  // namespace plumb::test
