#pragma once

#include <vector>

#include "plot/heat_map.hpp"
#include "stability/grid.hpp"

namespace plumb::tools {

/// What the colours of a map show.
enum class StabilityQuantity { stretch, energy };

/// End-mass ratio × links, at the grid's at_dt, one panel per method.
HeatMap map_of_links(const scenes::StabilityGrid& grid, const std::vector<scenes::StabilityResult>& results,
                     StabilityQuantity quantity);
/// End-mass ratio × step, at the grid's at_links, one panel per method.
HeatMap map_of_steps(const scenes::StabilityGrid& grid, const std::vector<scenes::StabilityResult>& results,
                     StabilityQuantity quantity);

}  // namespace plumb::tools
