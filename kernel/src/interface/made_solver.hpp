#pragma once

#include <cstdint>
#include <memory>
#include <utility>

#include "interface/solver.hpp"
#include "plumb/layouts/memory.hpp"

namespace plumb::detail {

/// Holds a solver and the slots of the particles that it has.
struct MadeSolver {
  struct Place {
    std::uint32_t particle;  ///< the scene's number
    Slot slot;
  };
  /// A rod, a tackle or a reel has a slot where its solver can say how it pulls and change its length.
  struct CordPlace {
    std::uint32_t cord;  ///< the scene's number of a rod, then those of tackles, then those of reels
    Slot slot;
  };
  std::unique_ptr<Solver> solver;
  Array<Place> places;
  Array<CordPlace> cords{};
  Array<std::pair<std::uint32_t, Slot>> twists{};  ///< the scene's numbers and the solver's
};

class TreeKinds;

/// Says what solvers start from, and by how much they had to change the initial state (see WorldInfo).
struct StartReport {
  bool goes_on = false;            ///< Solvers are handed the state of others, so that they change nothing.
  std::uint32_t relaxed_rods = 0;  ///< Rods of all of the world that share a budget, if that goes on.
  std::shared_ptr<TreeKinds> kinds{};     ///< of the world's trees, which new ones may share
  double projected_velocity = 0;          ///< m/s, the largest change
  double projected_position = 0;          ///< m, the largest change
  std::uint32_t unprojected_islands = 0;  ///< islands whose rods could not be brought to their lengths
};

}  // namespace plumb::detail
