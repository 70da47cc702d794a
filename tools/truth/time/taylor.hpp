#pragma once

#include <cstdint>
#include <vector>

#include "truth/constraint_solver.hpp"
#include "truth/model.hpp"

namespace plumb::truth {

/// The motion as a power series in time, x(t) = sum of x_k t^k and mu(t) likewise. Every coefficient follows
/// from the lower ones by the equations of motion and of the rods, with the one linear system that the
/// first, the acceleration, needs: with d = x_b - x_a,
///
///   (k+1)(k+2) M x_{k+2} - J_0ᵀ mu_k = [M g if k = 0] - drag (k+1) M x_{k+1} + sum_{j<k} mu_j d_{k-j},
///   J_0 x_{k+2} = -1/2 sum_{j=1..k+1} d_j·d_{k+2-j}
///
/// (recursion as in Hairer, Nørsett and Wanner, Solving Ordinary Differential Equations I, section I.8; the
/// constraint differentiated as often as there are coefficients). The order is whatever is asked for.
class TaylorSeries {
 public:
  /// Positions to the power order + 1, velocities to the power order: a one-step method of that order.
  TaylorSeries(const Model& model, std::uint32_t order);

  /// Around a state that keeps its rods, for which `solver` has been factored. O(n order²).
  void expand(const State& state, ConstraintSolver& solver);

  /// Seconds in which the last three coefficients add at most `tolerance`, to positions relative to the
  /// diagonal and to velocities relative to the speed of the model (the choice of Jorba and Zou,
  /// Experimental Mathematics 14, 2005, of the last two). Infinite if they vanish.
  Real choose_step(Real tolerance) const;

  void evaluate(Real t, State& out) const;

 private:
  Real& coefficient(std::vector<Real>& of, std::size_t item, std::size_t power) const {
    return of[item * powers_ + power];
  }
  void weigh_rods(std::size_t k);

  const Model& model_;
  std::size_t powers_;  ///< of t that are kept: order + 2
  // By item, the powers side by side: convolutions run along them.
  std::vector<Real> x_, y_, z_;     ///< of particles
  std::vector<Real> dx_, dy_, dz_;  ///< of rods, from a to b
  std::vector<Real> mu_;            ///< of rods
  std::vector<Real> norm_;          ///< of each power, the largest over the particles
  // Scratch.
  std::vector<Point> f_, a_;
  std::vector<Real> c_, push_;
};

}  // namespace plumb::truth
