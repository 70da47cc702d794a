#include "plot/chart.hpp"

#include <algorithm>

#include "plot/gnuplot.hpp"
#include "scenes/basics/numbers.hpp"

namespace plumb::tools {
namespace {

std::string script_for(const Chart& chart) {
  std::string s = "set title " + in_quotes(chart.title) + "\nset xlabel " + in_quotes(chart.x) +
                  "\nset ylabel " + in_quotes(chart.y) + (chart.log_x ? "\nset logscale x" : "") +
                  (chart.log_y ? "\nset logscale y" : "") +
                  "\nset format '%g'\nset grid lc rgb '#dddddd'\nset border 3 lc rgb '#555555'\n"
                  "set tics nomirror\nset key outside right top Left reverse samplen 2.5\n";
  std::string plot;
  for (std::size_t i = 0; i < chart.series.size(); ++i) {
    const Series& series = chart.series[i];
    if (series.points.empty()) continue;
    const std::string name = "$data" + std::to_string(i);
    s += name + " << EOD\n";
    for (const auto& [x, y] : series.points) {
      scenes::append_exact(s, x);
      s += ' ';
      scenes::append_exact(s, y);
      s += '\n';
    }
    s += "EOD\n";
    plot += (plot.empty() ? "plot " : ", ");
    plot += name + " using 1:2 with linespoints title " + in_quotes(series.name) + " lc rgb " +
            in_quotes(series.color) + (series.dashed ? " dt 2 pt 7" : " dt 1 pt 7") + " lw " +
            scenes::short_number(series.width) + " ps 0.5";
  }
  return s + (plot.empty() ? "set label 'no data' at graph 0.5,0.5\nplot [1:10] [1:10] NaN notitle" : plot) +
         "\n";
}

}  // namespace

std::string draw_svg(const Chart& chart) {
  // The legend stands beside the axes, so a chart with long names is wider.
  std::size_t longest = 0;
  for (const Series& series : chart.series) longest = std::max(longest, series.name.size());
  const int width = std::max(760, 600 + 10 * static_cast<int>(longest));
  return draw_svg(chart.title, width, 430, script_for(chart));
}

}  // namespace plumb::tools
