#pragma once

#include <array>

#include "plumb/vec3.hpp"

namespace plumb::detail {

/// These numbers of a bend never change. `weights` are those of its particles in w, in 1/m, and add up to 0.
/// Stiffness and damping are divided by the unit of mass.
struct BendNumbers {
  std::array<double, 3> weights;
  double stiffness, curvature, damping;
};

/// A substep forces a bend by `kick` (s^2), and damps it by kick/h = `damping` (s).
struct BendFactors {
  double kick, damping, theta;  ///< Theta is 1/2 for gradient mid, and 1 for new.
};

/// A bend pulls particle i by -weights[i] pull, and slope is the derivative of that pull by the end of w, by
/// rows.
struct BendPull {
  Vec3 pull;
  std::array<double, 9> slope;
};

/// Returns the pull of a bend whose w goes from `start` by `change` in a substep.
///
/// It is the discrete gradient along w (Gonzalez 1996). With theta 1/2 its work is the change of energy, and
/// it is along the mean of w, so that it has no torque. With theta 1 it is the derivative at the end.
///
/// Damping takes the part of the change along w at theta, because turning a bend as a whole may not brake it.
BendPull bend_pull(const BendNumbers& bend, const BendFactors& factors, Vec3 start, Vec3 change);

/// Returns the undamped pull at the end of a substep, with a slope that is never negative: what pushes from
/// the straight line is left out of it.
BendPull definite_bend_pull(const BendNumbers& bend, double kick, Vec3 end);

}  // namespace plumb::detail
