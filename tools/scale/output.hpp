#pragma once

#include <string>
#include <vector>

#include "plot/chart.hpp"
#include "plot/table.hpp"
#include "scale/results.hpp"

/// These functions show what `plumb scale` measured, as tables, charts and text. A dash stands where there is
/// no number.
namespace plumb::tools {

/// Has a row for every length, and a column for every series that was measured anywhere.
Table frames_table(const ScaleOptions& options, const ScaleResults& results);
Table rods_table(const ScaleOptions& options, const ScaleResults& results);
/// Says what became of a series' lengths, and the exponent over its longer half.
Table slope_table(const ScaleOptions& options, const ScaleResults& results);
/// Shows relaxation in detail: order, precision, times, threads and strain.
Table relax_table(const ScaleResults& results);
/// Shows the two numbers that the thesis gives for its five links, on an Athlon XP 1800+ (section 4.4.2).
Table five_links_table(const ScaleResults& results);
/// Shows the cheapest settings at equal error, with the exponent of each method over all lengths.
Table error_table(const ScaleOptions& options, const ScaleResults& results, ChainFamily family);
Table setting_table(const ScaleResults& results, ChainFamily family);

/// A comparison says what springs and relaxation came to, for a sentence. Slopes are exponents of links,
/// which are empty where there is none.
struct Comparison {
  std::optional<double> springs_slope, relax_slope;
  double springs_level = 0, relax_level = 0;  ///< Links up to which frames per second are level.
  double links = 0;                           ///< Most links at which both were measured.
  double springs_ns = 0, relax_ns = 0;        ///< Time per rod and frame at those links, in ns.
  /// Largest strain of any length, a second after the start.
  double springs_stretch = 0, relax_stretch = 0;
};
Comparison compare(const ScaleOptions& options, const ScaleResults& results);
/// Sets the thesis's conclusion beside what these numbers say.
std::string conclusion_of(const Comparison& comparison);
/// Does the same at equal error.
std::string conclusion_at_equal_error(const ScaleOptions& options, const ScaleResults& results,
                                      ChainFamily family);

std::string scale_text(const ScaleOptions& options);
std::string error_text(const ScaleOptions& options, const ScaleResults& results, ChainFamily family);

Chart frames_chart(const ScaleOptions& options, const ScaleResults& results);
Chart rods_chart(const ScaleOptions& options, const ScaleResults& results);
Chart stretch_chart(const ScaleOptions& options, const ScaleResults& results);
Chart error_chart(const ScaleOptions& options, const ScaleResults& results, ChainFamily family);

}  // namespace plumb::tools
