#pragma once

#include <string>
#include <utility>
#include <vector>

namespace plumb::tools {

struct Series {
  std::string name;
  /// Pairs of x and y, which must be positive where an axis is logarithmic.
  std::vector<std::pair<double, double>> points{};
  std::string color = "#1f5fa8";
  bool dashed = false;
  double width = 2;  ///< Width of the lines, in pixels.
};

/// A chart is a picture with two axes. They are logarithmic unless the chart says otherwise.
struct Chart {
  std::string title;
  std::string x;
  std::string y;
  std::vector<Series> series;
  bool log_x = true;
  bool log_y = true;
};

/// Returns the chart as SVG text, which gnuplot draws. Throws InputError with gnuplot's own words if it
/// fails.
std::string draw_svg(const Chart& chart);

}  // namespace plumb::tools
