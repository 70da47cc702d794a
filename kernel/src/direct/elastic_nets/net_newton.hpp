#pragma once

#include <memory>

#include "direct/elastic_nets/net_matrix.hpp"
#include "direct/loops/loop_state.hpp"
#include "interface/tally.hpp"
#include "plumb/layouts/memory.hpp"

namespace plumb::detail {

struct LoopWorkspace;

/// A wide island of rods that all give needs this to be solved without a factorisation.
struct NetWorkspace {
  explicit NetWorkspace(const NetPattern& pattern);

  NetMatrix matrix;
  Array<NetMatrix::RodPart> parts;  ///< They are by rod.
  Array<double> lacking;            ///< Multipliers lack this at the present delta, by rod.
  Array<Vec3> right, change;        ///< They are by node.
};

/// Solves a substep that begin() has prepared. Multipliers are unknowns of their own and are eliminated from
/// Newton's matrix. Of that, rods' directions are taken as those of their forces, which makes it symmetric.
/// What that leaves falls by the turn of rods in a substep every time, and conjugate gradients need not be
/// exact either. Returns whether it converged; work.delta and state.mu are spoiled if not.
bool iterate_net(LoopState& state, double theta, LoopWorkspace& work, Tally& counters);

/// Does what project_delta() does. Returns false if it did not converge, and has changed nothing then.
bool project_net(const LoopState& state, double kick, LoopWorkspace& work);

}  // namespace plumb::detail
