#pragma once

#include "direct/loops/loop_stepper.hpp"

namespace plumb::detail {

/// d and excess of every rod at the start of a substep.
void measure_rods(const LoopState& state, LoopWorkspace& work);

/// Newton's matrix at work.delta and state.mu, factorised. `soft` is the compliance of rods in units of their
/// 2 L^2/mass; with it, multipliers that push are left out of the matrix, so that it is definite for theta 1.
void factorize_newton(const LoopState& state, double theta, double soft, LoopWorkspace& work,
                      LoopWorkspace::Factor& factor);

/// Newton's change of displacements and multipliers into factor.right; its RMS over nodes relative to a rod.
double find_newton_change(const LoopState& state, double theta, double soft, LoopWorkspace& work,
                          LoopWorkspace::Factor& factor);
void apply_change(LoopState& state, double scale, LoopWorkspace& work, const LoopWorkspace::Factor& factor);

/// Largest |C| / L^2, at work.delta, of the rods that the factor left out as redundant: whether they fit.
double largest_misfit(const LoopState& state, const LoopWorkspace& work, const LoopWorkspace::Factor& factor);

/// (M (delta - delta0), delta - delta0)/2 + sum C^2/(2 soft), but for a constant, with M delta0 = load.
double elastic_energy(const LoopState& state, double soft, const LoopWorkspace& work);
/// mu = -C/soft
void set_elastic_multipliers(LoopState& state, double soft, const LoopWorkspace& work);

/// Moves work.delta, a velocity times a time, onto what no rod resists, adding what forces do:
/// M delta' = M delta + kick force + J^T lambda, J delta' = 0 with delta of fixed vertices as it is.
void project_delta(const LoopState& state, double kick, LoopWorkspace& work, LoopWorkspace::Factor& factor);

}  // namespace plumb::detail
