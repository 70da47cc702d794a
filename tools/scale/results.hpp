#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "scale/equal_error.hpp"
#include "scale/measure.hpp"
#include "scenes/basics/json.hpp"

/// All that `plumb scale` measured, and what its tables, charts and texts look up in it.
namespace plumb::tools {

/// Frames per second that fall by less than this factor are level.
inline constexpr double level_factor = 1.25;

struct ScaleResults {
  std::vector<ScaleCell> cells;
  std::vector<ScaleCell> five;  ///< the thesis's five links at 5 and 1000 sweeps
  std::vector<EqualErrorCell> errors;
};

/// Lengths at equal error: those asked for, of chains of 1 m none above ScaleOptions::most_fine, which itself
/// takes the place of longer ones.
std::vector<std::uint32_t> error_links_of(ChainFamily family, const ScaleOptions& options);

/// The series that were measured anywhere.
std::vector<ScaleSeries> measured_series(const ScaleOptions& options, const ScaleResults& results);

/// Whether the cap let it take its whole second, so that its stretch can be compared.
bool is_whole(const ScaleCell& cell);

/// Those that were measured at equal error.
std::vector<Method> methods_of(const ScaleResults& results, ChainFamily family);

std::string family_text(ChainFamily family);

std::string scale_csv(const ScaleResults& results);
scenes::Json scale_json(const ScaleOptions& options, const ScaleResults& results);

}  // namespace plumb::tools
