#pragma once

#include <memory>

#include "reference/mechanical_system.hpp"

namespace plumb::detail {

/// Makes the method of Lagrange multipliers (thesis §3.4) in the coordinates of the particles. It finds the
/// accelerations that keep the second derivatives of the rods' lengths at zero: M a - Jᵀ lambda = f, and J a
/// = -|v_a - v_b|² for every rod. It takes linear time on trees, and a sparse factorisation on islands with
/// loops.
///
/// What drifts is pulled back as MultiplierSettings says:
///
/// - not at all;
/// - by Baumgarte's feedback (1972), J a = -|v_a - v_b|² - 2 alpha C' - alpha² C with C = (|d|² - L²)/2;
/// - by projection after every substep: positions by Newton's method, then velocities, either by the least
///   change weighted by mass.
///
/// An anchor that changes its velocity does so by an impulse, which velocities take up under any
/// stabilization.
std::unique_ptr<MechanicalSystem> make_multipliers(const Scene& island, const Settings& settings);
/// Makes the same of an island with bodies, pins and alignments, which are further rows, and with springs,
/// torsions and drives of angles, which are forces. Its movable particles come first. It takes a sparse
/// factorisation.
std::unique_ptr<MechanicalSystem> make_jointed_multipliers(const Scene& island, const Settings& settings);

}  // namespace plumb::detail
