#pragma once

#include <span>
#include <vector>

#include "plot/heat_map.hpp"
#include "stability/grid.hpp"

namespace plumb::tools {

/// The colours of a map show one of these.
enum class StabilityQuantity { stretch, energy, depth };

/// A grid that was measured.
struct MeasuredGrid {
  scenes::StabilityGrid grid;
  std::vector<scenes::StabilityResult> results{};
};

/// Draws end-mass ratio × size, at the grid's at_dt, with one panel per method.
HeatMap map_of_sizes(const MeasuredGrid& measured, StabilityQuantity quantity);
/// Draws end-mass ratio × step, at the grid's at_size, with one panel per method.
HeatMap map_of_steps(const MeasuredGrid& measured, StabilityQuantity quantity);
/// Draws speed × step of what lands, with one panel per scene and method. All grids have the axes of the
/// first.
HeatMap map_of_landings(std::span<const MeasuredGrid> landings, StabilityQuantity quantity);

}  // namespace plumb::tools
