#pragma once

#include <cstdint>
#include <vector>

#include "truth/constraint_solver.hpp"
#include "truth/integrators/bent_series.hpp"
#include "truth/model.hpp"

namespace plumb::truth {

/// The motion is a power series in time, x(t) = sum of x_k t^k, and so is mu(t). Every coefficient follows
/// from the lower ones by the equations of motion and of the rods. All take the one linear system that the
/// first, the acceleration, needs. With d = x_b - x_a it says
///
///   (k+1)(k+2) M x_{k+2} - J_0ᵀ mu_k = [M g if k = 0] - drag (k+1) M x_{k+1} + sum_{j<k} mu_j d_{k-j},
///   J_0 x_{k+2} = -1/2 sum_{j=1..k+1} d_j·d_{k+2-j} + [rate²/2 if k = 0]
///
/// An elastic rod's mu_k is known beforehand and stands on the right. Its length l has a series too. It
/// follows from l l = d·d, and mu from mu l = -stiffness (l - L) - damping dl/dt, one coefficient
/// after the other:
///
///   l_0 l_k = 1/2 (sum_{j=0..k} d_j·d_{k-j} - sum_{j=1..k-1} l_j l_{k-j}),
///   l_0 mu_k = -stiffness (l_k - L_k) - damping (k+1) l_{k+1} - sum_{j<k} mu_j l_{k-j}
///
/// with L_0 its length at rest and L_1 the rate of that.
///
/// Bends and twists push likewise, see BentSeries.
///
/// The recursion is that of Hairer, Nørsett and Wanner, Solving Ordinary Differential Equations I, section
/// I.8. The constraint is differentiated as often as there are coefficients. The order is whatever is asked
/// for.
class TaylorSeries {
 public:
  /// Holds positions to the power order + 1 and velocities to the power order. So it is a one-step method of
  /// that order.
  TaylorSeries(const Model& model, std::uint32_t order);

  /// Expands around a state at time t (s) that keeps its rods, for which `solver` has been factored. It costs
  /// O(n order²).
  void expand(const State& state, Real t, ConstraintSolver& solver);

  /// Returns the seconds in which the last three coefficients add at most `tolerance`. Positions are relative
  /// to the diagonal, and velocities to the speed of the model. Jorba and Zou (Experimental Mathematics 14,
  /// 2005) take the last two. It is infinite if they vanish.
  Real choose_step(Real tolerance) const;

  void evaluate(Real t, State& out) const;
  /// Returns how a rod pulls at the state, in N; negative if it pushes.
  Real pull(std::size_t rod) const {
    const std::size_t first = rod * powers_;
    return -mu_[first] * (model_.rods[rod].elastic ? length_[first] : model_.rods[rod].length_at(time_));
  }

  /// Returns whether the series of the elastic rods' lengths hold up to `t`. Their ends may not meet before.
  /// At `t` they may be off the distances in `state` by at most `most` of those or of the diagonal.
  bool lengths_hold(Real t, const State& state, Real most) const;

 private:
  Real& coefficient(std::vector<Real>& of, std::size_t item, std::size_t power) const {
    return of[item * powers_ + power];
  }
  void weigh_rods(std::size_t k);
  void constrain(std::size_t k, std::size_t r);
  void expand_length(std::size_t k, std::size_t r);
  void expand_pull(std::size_t k, std::size_t r);

  const Model& model_;
  std::size_t powers_;  ///< Powers of t that are kept: order + 2.
  BentSeries bent_;
  Real time_ = 0;  ///< Time of the expansion, in s.
  // An item's powers lie side by side, because convolutions run along them.
  std::vector<Real> x_, y_, z_;     ///< Coefficients of particles.
  std::vector<Real> dx_, dy_, dz_;  ///< Coefficients of rods, from a to b.
  std::vector<Real> mu_;            ///< Multipliers of rods.
  std::vector<Real> length_;        ///< Coefficients of the lengths of elastic rods.
  std::vector<Real> norm_;          ///< Norm of each power, the largest over the particles.
  // These members are scratch.
  std::vector<Point> f_, a_;
  std::vector<Real> c_, push_;
};

}  // namespace plumb::truth
