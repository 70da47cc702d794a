#pragma once

#include "direct/loops/loop_stepper.hpp"

namespace plumb::detail {

/// Measures d (m) and excess (m²) of every rod at the start of a substep, and starts the laws of those that
/// give, with the factors of work.laws.
void measure_rods(const LoopState& state, LoopWorkspace& work);

/// At the present delta a rod has the direction of its force, the gradient of its row, `use` times its own
/// (both m), what it gives, and how far its equation is off (both m²).
struct RodTerms {
  Vec3 force, gradient;
  double use, soft, c;
};
/// Returns those of rod `k`. Between two held vertices a rod has nothing to do, and its multiplier becomes
/// zero.
RodTerms rod_terms(const LoopState& state, std::uint32_t k, double theta, double soft,
                   const LoopWorkspace& work);
/// Returns the row of rod `k` in a projection of velocities, at the present delta.
VelocityRow projected_row(const LoopState& state, std::uint32_t k, const LoopWorkspace& work);

/// Factorises Newton's matrix at work.delta and state.mu. `soft` is the compliance of rods in units of their
/// 2 L^2/mass. With it, multipliers that push are left out of the matrix, so that it is definite for theta 1.
void factorize_newton(const LoopState& state, double theta, double soft, LoopWorkspace& work,
                      LoopWorkspace::Factor& factor);

/// Says whether the cables that are taut now were when the matrix was factorised. Otherwise it is of no use.
bool has_same_cables(const LoopState& state, double theta, const LoopWorkspace& work,
                     const LoopWorkspace::Factor& factor);

/// Returns the compliance -C/mu of a rod, in m^2, for `soft` in units of 2 L^2.
inline double softness(const LoopState& state, std::uint32_t k, double soft) {
  return 2 * soft * state.length2[k];
}

/// Says whether rod `k`, which gives by a law, is stiffer by it than with the softness `give` (m^2).
inline bool is_softened(const LoopState& state, std::uint32_t k, double give, const LoopWorkspace& work) {
  return work.laws.factors.kick * state.laws.rods[k][0] * give > state.length2[k];
}

/// Puts Newton's change of displacements and multipliers into factor.right. Returns its RMS over nodes
/// relative to a rod.
double find_newton_change(const LoopState& state, double theta, double soft, LoopWorkspace& work,
                          LoopWorkspace::Factor& factor);
/// Adds `scale` times that change to work.delta and state.mu.
void apply_change(LoopState& state, double scale, LoopWorkspace& work, const LoopWorkspace::Factor& factor);

/// Returns the largest |C| / L^2, at work.delta, of the rods that the factor left out as redundant. It tells
/// whether they fit.
double largest_misfit(const LoopState& state, const LoopWorkspace& work, const LoopWorkspace::Factor& factor);

/// Moves work.delta, a velocity times a time, onto what no rod resists, and adds what forces do. It solves
/// M delta' = M delta + kick force + J^T lambda, J delta' = 0 with delta of fixed vertices as it is, and
/// leaves lambda in work.blows. Where fixed vertices jump, M also has the mass by which rods pass on from
/// them how their velocity changes.
void project_delta(const LoopState& state, const Projected& acts, LoopWorkspace& work,
                   LoopWorkspace::Factor& factor);

}  // namespace plumb::detail
