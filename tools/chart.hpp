#pragma once

#include <string>
#include <utility>
#include <vector>

namespace plumb::tools {

struct Series {
  std::string name;
  std::vector<std::pair<double, double>> points{};  ///< x, y; both positive, the axes are logarithmic
  std::string color = "#1f5fa8";
  bool dashed = false;
  double width = 2;  ///< of lines, in pixels
};

/// A picture with two logarithmic axes.
struct Chart {
  std::string title;
  std::string x;
  std::string y;
  std::vector<Series> series;
};

/// The chart as SVG text, drawn by gnuplot. Throws InputError with its own words if it fails.
std::string draw_svg(const Chart& chart);

}  // namespace plumb::tools
