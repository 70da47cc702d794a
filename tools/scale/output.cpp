#include "scale/output.hpp"

#include <algorithm>
#include <cmath>

#include "scenes/basics/lists.hpp"
#include "scenes/basics/numbers.hpp"
#include "scenes/runs/report.hpp"

namespace plumb::tools {
namespace {

using scenes::append_item;
using scenes::plain_number;
using scenes::short_number;

const std::string dash = "—";
/// Frames per second that fall by less than this factor are level.
constexpr double level_factor = 1.25;
/// Slopes that differ by less are alike: timing on a busy machine is no better.
constexpr double slope_room = 0.1;

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
  const bool is_float = series.method == Method::relax && series.precision == Precision::single;
  return is_float ? "#62b0e8" : color_of(series.method);
}

const ScaleCell* find_cell(const std::vector<ScaleCell>& cells, const ScaleSeries& series,
                           std::uint32_t links) {
  const auto it = std::find_if(cells.begin(), cells.end(), [&](const ScaleCell& cell) {
    return cell.series == series && cell.links == links;
  });
  return it == cells.end() ? nullptr : &*it;
}

std::vector<ScaleSeries> measured_series(const ScaleOptions& options, const ScaleResults& results) {
  std::vector<ScaleSeries> out = all_series(options);
  std::erase_if(out, [&](const ScaleSeries& series) { return timings_of(results.cells, series).empty(); });
  return out;
}

template <class Y>
Table table_by_links(const ScaleOptions& options, const ScaleResults& results, Y y) {
  const std::vector<ScaleSeries> columns = measured_series(options, results);
  std::vector<std::string> header{"links"};
  for (const ScaleSeries& series : columns) header.push_back(name_of(series));
  Table table(header);
  for (const std::uint32_t links : options.links) {
    std::vector<std::string> row{std::to_string(links)};
    for (const ScaleSeries& series : columns) {
      const ScaleCell* cell = find_cell(results.cells, series, links);
      row.push_back(cell && cell->measured() ? plain_number(y(*cell)) : dash);
    }
    table.add_row(row);
  }
  return table;
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

/// Whether the cap let it take its whole second, so that its stretch can be compared.
bool is_whole(const ScaleCell& cell) {
  return cell.measured() && cell.frames == scale_frames;
}

std::string count_text(double links) {
  return short_number(links, 7) + (links == 1 ? " link" : " links");
}

std::string slope_text(const std::optional<double>& slope) {
  return slope ? plain_number(*slope) : dash;
}

/// "1", or "1 to 8".
std::string substeps_text(const std::vector<ScaleCell>& cells, const ScaleSeries& series) {
  std::uint32_t least = 0, most = 0;
  for (const ScaleCell& cell : cells) {
    if (cell.series != series || !cell.measured()) continue;
    least = least == 0 ? cell.substeps : std::min(least, cell.substeps);
    most = std::max(most, cell.substeps);
  }
  return std::to_string(least) + (most > least ? " to " + std::to_string(most) : "");
}

/// "1 too slow, 2 broke": what kept cells from being measured.
std::string missing_text(const std::vector<ScaleCell>& cells, const ScaleSeries& series) {
  std::string out;
  const auto add = [&](CellOutcome outcome, const char* word) {
    std::string lengths;
    for (const ScaleCell& cell : cells)
      if (cell.series == series && cell.outcome == outcome) append_item(lengths, std::to_string(cell.links));
    if (!lengths.empty()) append_item(out, lengths + " " + word, "; ");
  };
  add(CellOutcome::refused, "refused");
  add(CellOutcome::broke, "broke");
  add(CellOutcome::too_slow, "too slow");
  add(CellOutcome::left_out, "left out");
  return out.empty() ? "none" : out;
}

std::string with_slopes(const std::string& one, const std::optional<double>& slope) {
  return one + (slope ? " (slope " + plain_number(*slope) + ")" : " (too few lengths for a slope)");
}

/// "alike", or which grows more slowly.
std::string better_of(double springs, double relax) {
  if (std::abs(springs - relax) < slope_room) return "both scale alike";
  return springs < relax ? "springs scale better" : "relaxation scales better";
}

std::vector<Method> methods_of(const ScaleResults& results, ChainFamily family) {
  std::vector<Method> out;
  for (const EqualErrorCell& cell : results.errors)
    if (cell.family == family && std::find(out.begin(), out.end(), cell.method) == out.end())
      out.push_back(cell.method);
  return out;
}

std::string family_text(ChainFamily family) {
  return family == ChainFamily::equal_links ? "links of 10 cm and 1 kg" : "chains of 1 m and 1 kg";
}

}  // namespace

std::vector<std::uint32_t> error_links_of(ChainFamily family, const ScaleOptions& options) {
  std::vector<std::uint32_t> out = options.error_links;
  if (family == ChainFamily::equal_length)
    for (std::uint32_t& links : out) links = std::min(links, options.most_fine);
  out.erase(std::unique(out.begin(), out.end()), out.end());
  return out;
}

Table frames_table(const ScaleOptions& options, const ScaleResults& results) {
  return table_by_links(options, results, [](const ScaleCell& c) { return c.frames_per_s(); });
}

Table rods_table(const ScaleOptions& options, const ScaleResults& results) {
  return table_by_links(options, results, [](const ScaleCell& c) { return c.ns_per_rod(); });
}

Table slope_table(const ScaleOptions& options, const ScaleResults& results) {
  Table table({"method", "a frame", "substeps", "longest", "slope", "ns per rod there", "level until",
               "not measured"});
  for (const ScaleSeries& series : measured_series(options, results)) {
    const std::vector<Timing> timings = timings_of(results.cells, series);
    const auto& [links, seconds] = timings.back();
    // All threads are used from some length on, where nothing is level any more.
    const double level = series.all_threads ? 0 : level_until(timings, level_factor);
    table.add_row({name_of(series), describe(settings_of(series, options)),
                   substeps_text(results.cells, series), short_number(links, 7),
                   slope_text(fit_longer_half(timings)), plain_number(1e9 * seconds / links),
                   level > 0 ? short_number(level, 7) : dash, missing_text(results.cells, series)});
  }
  return table;
}

Table relax_table(const ScaleResults& results) {
  Table table({"links", "arithmetic", "threads", "frames/s", "µs a frame", "median", "ns per rod",
               "stretch RMS", "stretch max"});
  for (const ScaleCell& r : results.cells) {
    if (r.series.method != Method::relax || !r.measured()) continue;
    table.add_row({std::to_string(r.links), std::string(to_string(r.series.precision)),
                   std::to_string(r.threads), plain_number(r.frames_per_s()), plain_number(1e6 * r.least_s),
                   plain_number(1e6 * r.median_s), plain_number(r.ns_per_rod()),
                   is_whole(r) ? plain_number(100 * r.stretch.rms) + " %" : dash,
                   is_whole(r) ? plain_number(100 * r.stretch.max) + " %" : dash});
  }
  return table;
}

Table five_links_table(const ScaleResults& results) {
  Table table({"five links", "thesis, frames/s", "here, frames/s", "stretch RMS"});
  for (const ScaleCell& r : results.five) {
    table.add_row({std::to_string(r.sweeps) + " sweeps, " + std::string(to_string(r.series.precision)),
                   r.sweeps == 5 ? "597" : "30", r.measured() ? plain_number(r.frames_per_s()) : dash,
                   plain_number(100 * r.stretch.rms) + " %"});
  }
  return table;
}

Table error_table(const ScaleOptions& options, const ScaleResults& results, ChainFamily family) {
  std::vector<std::string> header{"µs a rod and simulated second"};
  for (const std::uint32_t links : error_links_of(family, options))
    header.push_back(std::to_string(links) + " links");
  header.emplace_back("slope");
  Table table(header);
  for (const Method method : methods_of(results, family)) {
    std::vector<std::string> row{std::string(to_string(method))};
    for (const std::uint32_t links : error_links_of(family, options)) {
      const auto it =
          std::find_if(results.errors.begin(), results.errors.end(), [&](const EqualErrorCell& cell) {
            return cell.family == family && cell.method == method && cell.links == links;
          });
      const bool met = it != results.errors.end() && it->cheapest;
      row.push_back(met ? plain_number(1e3 * it->cheapest->ms / links) : dash);
    }
    row.push_back(slope_text(fit_slope(timings_of(results.errors, family, method))));
    table.add_row(row);
  }
  return table;
}

Table setting_table(const ScaleResults& results, ChainFamily family) {
  Table table({"links", "method", "cheapest setting", "ms per s", "error"});
  for (const EqualErrorCell& cell : results.errors) {
    if (cell.family != family) continue;
    const auto& best = cell.cheapest;
    table.add_row({std::to_string(cell.links), std::string(to_string(cell.method)),
                   best ? best->setting : dash, best ? plain_number(best->ms) : dash,
                   best ? plain_number(100 * best->error) + " %" : dash});
  }
  return table;
}

Comparison compare(const ScaleOptions& options, const ScaleResults& results) {
  Comparison out;
  const ScaleSeries springs{.method = Method::springs};
  ScaleSeries relax{.method = Method::relax};  // in double, as springs are, where that was measured
  if (std::find(options.precisions.begin(), options.precisions.end(), relax.precision) ==
      options.precisions.end())
    relax.precision = options.precisions.front();
  const std::vector<Timing> s = timings_of(results.cells, springs), r = timings_of(results.cells, relax);
  out.springs_slope = fit_longer_half(s);
  out.relax_slope = fit_longer_half(r);
  out.springs_level = level_until(s, level_factor);
  out.relax_level = level_until(r, level_factor);
  for (const ScaleCell& cell : results.cells) {
    if (!is_whole(cell)) continue;
    if (cell.series == springs) out.springs_stretch = std::max(out.springs_stretch, cell.stretch.max);
    if (cell.series == relax) out.relax_stretch = std::max(out.relax_stretch, cell.stretch.max);
  }
  for (const auto& [links, springs_s] : s)
    for (const auto& [same, relax_s] : r)
      if (links == same) {
        out.links = links;
        out.springs_ns = 1e9 * springs_s / links;
        out.relax_ns = 1e9 * relax_s / links;
      }
  return out;
}

std::string conclusion_of(const Comparison& c) {
  if (!c.springs_slope || !c.relax_slope || c.links == 0)
    return "The thesis concludes that springs are \"much more scaleable\" (section 4.4.3); too few lengths "
           "of springs and relaxation were measured here to say.";
  const bool springs_faster = c.springs_ns < c.relax_ns;
  const double times = springs_faster ? c.relax_ns / c.springs_ns : c.springs_ns / c.relax_ns;
  const double difference = *c.springs_slope - *c.relax_slope;
  std::string out =
      "The thesis sees springs level until about 40 links and relaxation fall from the start, and concludes "
      "that springs are \"much more scaleable\" (section 4.4.3). Here frames per second of springs are level "
      "(to " +
      plain_number(100 * (level_factor - 1), 2) + " %) until " + count_text(c.springs_level) +
      ", of relaxation until " + count_text(c.relax_level) +
      "; over the longer half of their lengths the time of a frame grows as links to the power " +
      plain_number(*c.springs_slope) + " (springs) and " + plain_number(*c.relax_slope) +
      " (relaxation): " + better_of(*c.springs_slope, *c.relax_slope) + ". At " + short_number(c.links, 7) +
      " links a rod takes " + plain_number(c.springs_ns) + " ns with springs and " +
      plain_number(c.relax_ns) + " ns relaxed, so " + (springs_faster ? "springs are " : "relaxation is ") +
      plain_number(times, 2) + " times as fast. The thesis's conclusion ";
  out += difference < -slope_room ? "holds" : "does not hold";
  return out + " for a frame of fixed settings. With these settings rods stretch by up to " +
         plain_number(100 * c.springs_stretch) + " % (springs) and " + plain_number(100 * c.relax_stretch) +
         " % (relaxed).";
}

std::string conclusion_at_equal_error(const ScaleOptions& options, const ScaleResults& results,
                                      ChainFamily family) {
  const auto slope = [&](Method method) { return fit_slope(timings_of(results.errors, family, method)); };
  std::string out = "At " + short_number(100 * options.target) + " % of error, " + family_text(family) + ": ";
  std::string methods;
  for (const Method method : methods_of(results, family))
    append_item(methods, with_slopes(std::string(to_string(method)), slope(method)));
  out += methods + ".";
  const auto springs = slope(Method::springs), relax = slope(Method::relax);
  if (springs && relax) out += " Of springs and relaxation, " + better_of(*springs, *relax) + ".";
  // At the longest chain that both reach.
  const std::vector<Timing> s = timings_of(results.errors, family, Method::springs);
  const std::vector<Timing> r = timings_of(results.errors, family, Method::relax);
  for (auto it = s.rbegin(); it != s.rend(); ++it) {
    const auto same = std::find_if(r.begin(), r.end(), [&](const Timing& t) { return t.first == it->first; });
    if (same == r.end()) continue;
    const bool springs_faster = it->second < same->second;
    const double times = springs_faster ? same->second / it->second : it->second / same->second;
    out += " At " + short_number(it->first, 7) + " links, the longest that both reach, " +
           (springs_faster ? "springs are " : "relaxation is ") + plain_number(times, 2) +
           " times as fast to that error.";
    break;
  }
  if (r.size() > s.size())
    out += " Springs reach it at " + std::to_string(s.size()) + " of the lengths, relaxation at " +
           std::to_string(r.size()) + ".";
  return out;
}

std::string what_text(const ScaleOptions& options) {
  return "Chains of equal masses, horizontal at first, in frames of 1/60 s, without substeps where a chain "
         "survives that and in twice as many until it does: times of a frame, mean over the first simulated "
         "second, the least of " +
         std::to_string(options.repetitions) +
         " repetitions where they are short. Settings are fixed; relaxation takes " +
         std::to_string(options.sweeps) +
         " sweeps a frame, springs are as stiff as semi-implicit Euler bears. That fixes the time per rod, "
         "not how well rods keep their length: relaxed, the largest stretch grows with the chain until, in "
         "the longest, most rods still fall freely after a second. A chain is stepped for " +
         short_number(options.cell_s) +
         " s of wall-clock time at most and timed over the frames done by then; a dash: those would be fewer "
         "than ten, or the method does not move it. All methods "
         "but relaxation in double on one thread; \"threads\" where all of them were used. Slopes are "
         "exponents of links, fitted to the longer half of a method's lengths; level until: the longest "
         "chain whose frames take no more than " +
         plain_number(level_factor) + " times those of the shortest.";
}

std::string error_text(const ScaleOptions& options, const ScaleResults& results, ChainFamily family) {
  std::string moved;
  for (const std::uint32_t links : error_links_of(family, options))
    for (const EqualErrorCell& cell : results.errors)
      if (cell.family == family && cell.links == links) {
        append_item(moved, plain_number(100 * cell.moved) + " % of its length at " + std::to_string(links));
        break;
      }
  return "The cheapest setting found of each method, one thread, that brings " + family_text(family) +
         " to within " + short_number(100 * options.target) +
         " % of the chain's length of the truth after a second (RMS over particles). In that second a chain "
         "moves by " +
         moved +
         (family == ChainFamily::equal_links ? ", so that the longer it is, the less is asked." : ".");
}

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

std::string scale_csv(const ScaleResults& results) {
  std::string csv =
      "links,method,sweeps,substeps,precision,threads,frames,least_s,median_s,frames_per_s,ns_per_rod,"
      "stretch_rms,stretch_max,"
      "state_hash\n";
  for (const ScaleCell& r : results.cells) {
    if (!r.measured()) continue;
    std::string line = std::to_string(r.links) + "," + std::string(to_string(r.series.method)) + "," +
                       (r.series.method == Method::relax ? std::to_string(r.sweeps) : "") + "," +
                       std::to_string(r.substeps) + "," + std::string(to_string(r.series.precision)) + "," +
                       std::to_string(r.threads) + "," + std::to_string(r.frames);
    for (const double v :
         {r.least_s, r.median_s, r.frames_per_s(), r.ns_per_rod(), r.stretch.rms, r.stretch.max}) {
      append_item(line, short_number(v, 9), ",");
    }
    csv += line + "," + scenes::hash_text(r.state_hash) + "\n";
  }
  return csv;
}

scenes::Json scale_json(const ScaleOptions& options, const ScaleResults& results) {
  const auto cells_json = [](const std::vector<ScaleCell>& cells) {
    scenes::Json list = scenes::Json::array();
    for (const ScaleCell& r : cells) {
      if (!r.measured()) continue;
      scenes::Json entry{{"links", r.links},
                         {"method", std::string(to_string(r.series.method))},
                         {"sweeps", r.series.method == Method::relax ? scenes::Json(r.sweeps) : nullptr},
                         {"substeps", r.substeps},
                         {"precision", std::string(to_string(r.series.precision))},
                         {"threads", r.threads},
                         {"frames", r.frames},
                         {"least_s", r.least_s},
                         {"median_s", r.median_s},
                         {"frames_per_s", r.frames_per_s()},
                         {"ns_per_rod", r.ns_per_rod()}};
      entry["stretch"] = {{"rms", r.stretch.rms}, {"max", r.stretch.max}, {"max_rod", r.stretch.max_rod}};
      entry["state_hash"] = scenes::hash_text(r.state_hash);
      list.push_back(entry);
    }
    return list;
  };
  scenes::Json json;
  json["five_links"] = cells_json(results.five);
  json["chains"] = cells_json(results.cells);
  json["slopes"] = scenes::Json::array();
  for (const ScaleSeries& series : measured_series(options, results)) {
    const std::vector<Timing> timings = timings_of(results.cells, series);
    json["slopes"].push_back({{"series", name_of(series)},
                              {"setting", describe(settings_of(series, options))},
                              {"slope", fit_longer_half(timings)},
                              {"level_until", level_until(timings, level_factor)}});
  }
  json["equal_error"] = scenes::Json::array();
  for (const EqualErrorCell& cell : results.errors) {
    const auto& best = cell.cheapest;
    json["equal_error"].push_back({{"scene", chain_spec(cell.family, cell.links)},
                                   {"target", options.target},
                                   {"method", std::string(to_string(cell.method))},
                                   {"setting", best ? scenes::Json(best->setting) : nullptr},
                                   {"ms_per_s", best ? scenes::Json(best->ms) : nullptr},
                                   {"position_error", best ? scenes::Json(best->error) : nullptr}});
  }
  return json;
}

}  // namespace plumb::tools
