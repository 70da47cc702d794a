#pragma once

#include <string>
#include <utility>
#include <vector>

namespace plumb::tools {

struct Series {
  std::string name;
  std::vector<std::pair<double, double>> points{};  ///< x, y; positive on logarithmic axes
  std::string color = "#1f5fa8";
  bool dashed = false;
  double width = 2;  ///< of lines, in pixels
};

/// A picture with two axes, logarithmic unless said otherwise.
struct Chart {
  std::string title;
  std::string x;
  std::string y;
  std::vector<Series> series;
  bool log_x = true;
  bool log_y = true;
};

/// The chart as SVG text, drawn by gnuplot. Throws InputError with its own words if it fails.
std::string draw_svg(const Chart& chart);

}  // namespace plumb::tools
