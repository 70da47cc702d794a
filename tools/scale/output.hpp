#pragma once

#include <string>
#include <vector>

#include "plot/chart.hpp"
#include "plot/table.hpp"
#include "scale/results.hpp"

/// What `plumb scale` measured, as tables, charts and text. Cells without a number hold a dash.
namespace plumb::tools {

/// Every length in a row, every series that was measured anywhere in a column.
Table frames_table(const ScaleOptions& options, const ScaleResults& results);
Table rods_table(const ScaleOptions& options, const ScaleResults& results);
/// What became of a series' lengths, and the slope of its longer half.
Table slope_table(const ScaleOptions& options, const ScaleResults& results);
/// Relaxation in detail: times, threads, stretch.
Table relax_table(const ScaleResults& results);
/// The two numbers that the thesis gives for its five links, on an Athlon XP 1800+ (section 4.4.2).
Table five_links_table(const ScaleResults& results);
/// Cheapest settings at equal error, with the slope of each method over all lengths.
Table error_table(const ScaleOptions& options, const ScaleResults& results, ChainFamily family);
Table setting_table(const ScaleResults& results, ChainFamily family);

/// What springs and relaxation came to, for a sentence. Slopes are exponents of links; empty where there is
/// none.
struct Comparison {
  std::optional<double> springs_slope, relax_slope;
  double springs_level = 0, relax_level = 0;      ///< links until which frames per second are level
  double links = 0;                               ///< the most that both were measured at
  double springs_ns = 0, relax_ns = 0;            ///< per rod and frame, there
  double springs_stretch = 0, relax_stretch = 0;  ///< largest of any length, a second after the start
};
Comparison compare(const ScaleOptions& options, const ScaleResults& results);
/// The thesis's conclusion beside what these numbers say.
std::string conclusion_of(const Comparison& comparison);
/// The same at equal error.
std::string conclusion_at_equal_error(const ScaleOptions& options, const ScaleResults& results,
                                      ChainFamily family);

std::string what_text(const ScaleOptions& options);
std::string error_text(const ScaleOptions& options, const ScaleResults& results, ChainFamily family);

Chart frames_chart(const ScaleOptions& options, const ScaleResults& results);
Chart rods_chart(const ScaleOptions& options, const ScaleResults& results);
Chart stretch_chart(const ScaleOptions& options, const ScaleResults& results);
Chart error_chart(const ScaleOptions& options, const ScaleResults& results, ChainFamily family);

}  // namespace plumb::tools
