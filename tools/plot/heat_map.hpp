#pragma once

#include <string>
#include <utility>
#include <vector>

namespace plumb::tools {

/// A cell is named by its places among the columns (from the left) and rows (from below).
struct HeatCell {
  std::size_t column = 0, row = 0;
  /// Value that the colour shows. It is positive, and what is not a number counts as very large.
  double value = 0;
  bool crossed = false;  ///< Whether a cross is drawn on the cell.
  bool missing = false;  ///< Whether the cell is grey with a ring, since it has no value.
};
struct HeatPanel {
  std::string title;
  std::vector<HeatCell> cells;
};

/// A heat map has its panels side by side, three to a line. All share the axes and the colours.
struct HeatMap {
  std::string title;
  std::string x, y;
  std::vector<std::string> columns, rows;  ///< Words at the ticks of the axes.
  std::vector<HeatPanel> panels;
  std::string quantity;  ///< Words that say what the colours mean.
  /// Powers of ten between which the colours run. Values beyond get the colour of the nearer end.
  int least = -6, most = 0;
  std::string crossed, missing;  ///< Words that say what the two marks mean.
};

/// Returns the map as SVG text, which gnuplot draws. Colours run from light yellow to dark violet. They are
/// ordered by lightness, so that colour-blind eyes and grey prints see the same order. Throws InputError with
/// gnuplot's own words if it fails.
std::string draw_svg(const HeatMap& map);

}  // namespace plumb::tools
