#pragma once

#include <cstdint>

#include "truth/integrators/taylor.hpp"

namespace plumb::truth {

/// Follows a model from a start. After every step, positions and velocities are put back onto the rods by the
/// least change weighted by mass. So what each step leaves cannot add up. The model must outlive the
/// integrator.
class Integrator {
 public:
  struct Settings {
    std::uint32_t order = 24;
    Real tolerance = 1e-18L;  ///< Tolerance of a step, see TaylorSeries::choose_step().
  };

  /// Projects the start, see velocity_change(). Throws Unreachable if its rods cannot be kept.
  Integrator(const Model& model, State start, Settings settings);

  /// Takes steps of chosen lengths, the last one to exactly `t`. Throws Unreachable if the steps shrink to
  /// nothing.
  void advance_to(Real t);
  /// Takes one step of h seconds, whatever the tolerance says.
  void step(Real h);
  /// Adds how rods pull now (N), times `by`. Of redundant rods some have zero.
  void add_pulls(Real by, std::vector<Real>& out);

  const State& state() const { return state_; }
  Real time() const { return time_; }
  std::uint64_t steps() const { return steps_; }
  /// Returns by how much the start's velocities were changed at most, in m/s, because they pulled on rods.
  Real velocity_change() const { return velocity_change_; }
  const ConstraintSolver& solver() const { return solver_; }

 private:
  void expand();
  Real shorten_step(Real h, Real most);
  void finish_step(Real h);
  Real project();
  [[noreturn]] void refuse_stretch(const WorstRod& worst) const;
  [[noreturn]] void refuse_shrinking() const;
  void refuse_folds() const;

  const Model& model_;
  Settings settings_;
  ConstraintSolver solver_;
  TaylorSeries series_;
  State state_;
  State next_;
  Real time_ = 0;
  Real velocity_change_ = 0;
  std::uint64_t steps_ = 0;
  // These members are scratch.
  std::vector<Point> none_, change_;
  std::vector<Real> c_, push_;
};

}  // namespace plumb::truth
