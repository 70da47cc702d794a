#pragma once

#include <cstdint>
#include <memory>

#include "interface/island_sets.hpp"
#include "interface/made_solver.hpp"
#include "plumb/layouts/memory.hpp"

namespace plumb::detail {

/// These rules say how a set of islands is solved directly.
struct DirectRules {
  Gradient gradient = Gradient::mid;
  std::uint32_t time_order = 2;
  bool changes_gradient = false;             ///< Trees may take gradient mid while they are calm.
  bool bounds_frames = false;                ///< Substeps may take so many times the usual work (Effort).
  Precision precision = Precision::double_;  ///< of trees; islands with loops or elements have double

  bool operator==(const DirectRules&) const = default;
};

/// Makes the solvers of islands of particles and rods: lane groups of equal trees, and islands with loops one
/// by one. `sets` lists the islands, those with equal graphs together. Positions are projected so that rods
/// start at their lengths; a first substep would do that by a velocity, the greater the shorter it is. Then
/// velocities are projected so that nothing pulls on a rod.
Array<MadeSolver> make_direct_solvers(const Scene& scene, const IslandSets& sets, const Settings& settings,
                                      const DirectRules& rules, StartReport& report);

}  // namespace plumb::detail
