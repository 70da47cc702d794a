#include "scale/output.hpp"
#include "scenes/basics/numbers.hpp"

namespace plumb::tools {
namespace {

using scenes::short_number;

std::string color_of(Method method) {
  switch (method) {
    case Method::relax:
      return "#1f5fa8";
    case Method::direct:
      return "#2a9d5c";
    case Method::springs:
      return "#d1495b";
    case Method::multipliers:
      return "#e08e2b";
    case Method::featherstone:
      return "#7b4fb5";
    case Method::automatic:
      break;
  }
  return "#333333";
}

std::string color_of(const ScaleSeries& series) {
  if (series.method != Method::relax) return color_of(series.method);
  const bool is_float = series.precision == Precision::single;
  if (series.order == SweepOrder::jacobi) return is_float ? "#c9a08a" : "#8c564b";
  return is_float ? "#62b0e8" : color_of(series.method);
}

template <class Y>
std::vector<Series> series_of(const ScaleOptions& options, const ScaleResults& results, Y y) {
  std::vector<Series> out;
  for (const ScaleSeries& series : measured_series(options, results)) {
    Series line{.name = name_of(series), .color = color_of(series), .dashed = series.all_threads};
    for (const ScaleCell& cell : results.cells)
      if (cell.series == series && cell.measured() && y(cell) > 0)
        line.points.emplace_back(cell.links, y(cell));
    out.push_back(line);
  }
  return out;
}

}  // namespace

Chart frames_chart(const ScaleOptions& options, const ScaleResults& results) {
  return {"frames a second against links", "links", "frames/s",
          series_of(options, results, [](const ScaleCell& c) { return c.frames_per_s(); })};
}

Chart rods_chart(const ScaleOptions& options, const ScaleResults& results) {
  return {"time per rod and frame", "links", "ns",
          series_of(options, results, [](const ScaleCell& c) { return c.ns_per_rod(); })};
}

Chart stretch_chart(const ScaleOptions& options, const ScaleResults& results) {
  Chart chart{
      "stretch after 1 s", "links", "largest stretch, %",
      series_of(options, results, [](const ScaleCell& c) { return is_whole(c) ? 100 * c.stretch.max : 0; })};
  std::erase_if(chart.series, [](const Series& s) {
    return s.dashed || (s.name != "springs" && s.name.find("relax") == std::string::npos);
  });
  return chart;
}

Chart error_chart(const ScaleOptions& options, const ScaleResults& results, ChainFamily family) {
  Chart chart{
      .title = short_number(100 * options.target) + " % position error at 1 s, " + family_text(family),
      .x = "links",
      .y = "µs per rod and simulated second",
      .series = {}};
  for (const Method method : methods_of(results, family)) {
    Series line{.name = std::string(to_string(method)), .color = color_of(method)};
    for (const auto& [links, seconds] : timings_of(results.errors, family, method))
      line.points.emplace_back(links, 1e6 * seconds / links);
    chart.series.push_back(line);
  }
  return chart;
}

}  // namespace plumb::tools
