#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "scale/equal_error.hpp"
#include "scale/measure.hpp"
#include "scenes/basics/json.hpp"

/// These types hold all that `plumb scale` measured. The functions look up what tables, charts and texts
/// need.
namespace plumb::tools {

/// Frames per second that fall by less than this factor count as level.
inline constexpr double level_factor = 1.25;

struct ScaleResults {
  std::vector<ScaleCell> cells;
  std::vector<ScaleCell> five;  ///< The thesis's five links at 5 and 1000 sweeps.
  std::vector<EqualErrorCell> errors;
};

/// Returns the lengths that are measured at equal error. A chain of 1 m has at most ScaleOptions::most_fine
/// links, which takes the place of longer ones.
std::vector<std::uint32_t> error_links_of(ChainFamily family, const ScaleOptions& options);

/// Returns the series that were measured anywhere.
std::vector<ScaleSeries> measured_series(const ScaleOptions& options, const ScaleResults& results);

/// Whether the cap let the cell take its whole second, so that its strain can be compared.
bool is_whole(const ScaleCell& cell);

/// Returns the methods that were measured at equal error.
std::vector<Method> methods_of(const ScaleResults& results, ChainFamily family);

std::string family_text(ChainFamily family);

std::string scale_csv(const ScaleResults& results);
scenes::Json scale_json(const ScaleOptions& options, const ScaleResults& results);

}  // namespace plumb::tools
