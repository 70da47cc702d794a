#pragma once

#include <vector>

#include "plot/heat_map.hpp"
#include "stability/grid.hpp"

namespace plumb::tools {

/// The colours of a map show one of these.
enum class StabilityQuantity { stretch, energy };

/// Draws end-mass ratio × links, at the grid's at_dt, with one panel per method.
HeatMap map_of_links(const scenes::StabilityGrid& grid, const std::vector<scenes::StabilityResult>& results,
                     StabilityQuantity quantity);
/// Draws end-mass ratio × step, at the grid's at_links, with one panel per method.
HeatMap map_of_steps(const scenes::StabilityGrid& grid, const std::vector<scenes::StabilityResult>& results,
                     StabilityQuantity quantity);

}  // namespace plumb::tools
