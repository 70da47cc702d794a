#pragma once

#include <string>
#include <utility>
#include <vector>

namespace plumb::tools {

/// A cell is named by its places among the columns (from the left) and rows (from below).
struct HeatCell {
  std::size_t column = 0, row = 0;
  double value = 0;      ///< positive; what is not a number counts as very large
  bool crossed = false;  ///< with a cross on it
  bool missing = false;  ///< grey with a ring instead of a colour
};
struct HeatPanel {
  std::string title;
  std::vector<HeatCell> cells;
};

/// Panels side by side, three to a line, all with the same axes and the same colours.
struct HeatMap {
  std::string title;
  std::string x, y;
  std::vector<std::string> columns, rows;  ///< what the ticks say
  std::vector<HeatPanel> panels;
  std::string quantity;  ///< what the colours mean
  int least = -6,
      most = 0;  ///< powers of ten between which the colours run; values beyond have the last ones
  std::string crossed, missing;  ///< what the marks mean
};

/// The map as SVG text, drawn by gnuplot. Colours run from light yellow to dark violet, ordered by lightness,
/// so that eyes without one of the cones, and grey prints, see the same order. Throws InputError with
/// gnuplot's own words if it fails.
std::string draw_svg(const HeatMap& map);

}  // namespace plumb::tools
