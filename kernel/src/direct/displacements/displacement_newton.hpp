#pragma once

#include "direct/loops/loop_state.hpp"
#include "interface/tally.hpp"
#include "linear/sparse_ldu.hpp"
#include "plumb/layouts/memory.hpp"

namespace plumb::detail {

struct LoopWorkspace;

/// Newton's matrix of an island of massless rigid rods, with multipliers eliminated. Every rod's row has a
/// compliance so small that a change of displacements has six sound digits at least, and then
///
///   K = M - theta Lambda + sum over rods of (force direction) (gradient)ᵀ / compliance
///
/// has three numbers a node and as many neighbours as rods. It takes a fifth of the multiplications that the
/// matrix with multipliers takes (LoopSystem). Newton's iteration ends where rods have their lengths without
/// any compliance. Rods that others make redundant share what they bear.
struct DisplacementFactor {
  DisplacementFactor(const LoopTopology& topology, Isa isa);

  SparseAnalysis analysis;  ///< Its values are nine for every node, then eighteen for every rod.
  SparseLdu ldu;
  Array<double> values, smallest, right;
  Array<double> force,
      gradient;  ///< Rods had these directions (m) when it was made, three numbers each.
};

/// Solves a substep that begin() has prepared, by Newton's method as it is. Only iterations that converge
/// fast use a factor again. Returns whether it did; work.delta and state.mu are spoiled if not.
bool iterate_by_displacements(LoopState& state, double theta, DisplacementFactor& factor, LoopWorkspace& work,
                              Tally& counters);

}  // namespace plumb::detail
