#include "scale/output.hpp"
#include "scenes/basics/lists.hpp"
#include "scenes/basics/numbers.hpp"

namespace plumb::tools {
namespace {

using scenes::append_item;
using scenes::plain_number;
using scenes::short_number;

const ScaleCell* find_cell(const std::vector<ScaleCell>& cells, const ScaleSeries& series,
                           std::uint32_t links) {
  const auto it = std::find_if(cells.begin(), cells.end(), [&](const ScaleCell& cell) {
    return cell.series == series && cell.links == links;
  });
  return it == cells.end() ? nullptr : &*it;
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
      row.push_back(cell && cell->measured() ? plain_number(y(*cell)) : no_value);
    }
    table.add_row(row);
  }
  return table;
}

std::string slope_text(const std::optional<double>& slope) {
  return slope ? plain_number(*slope) : no_value;
}

/// Says how many substeps a series took, such as "1" or "1 to 8".
std::string substeps_text(const std::vector<ScaleCell>& cells, const ScaleSeries& series) {
  std::uint32_t least = 0, most = 0;
  for (const ScaleCell& cell : cells) {
    if (cell.series != series || !cell.measured()) continue;
    least = least == 0 ? cell.substeps : std::min(least, cell.substeps);
    most = std::max(most, cell.substeps);
  }
  return std::to_string(least) + (most > least ? " to " + std::to_string(most) : "");
}

/// Says what kept cells from being measured, such as "1 too slow, 2 broke".
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

}  // namespace

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
    // Long chains use all threads, and nothing is level there any more.
    const double level = series.all_threads ? 0 : level_until(timings, level_factor);
    table.add_row({name_of(series), describe(settings_of(series, options)),
                   substeps_text(results.cells, series), short_number(links, 7),
                   slope_text(fit_longer_half(timings)), plain_number(1e9 * seconds / links),
                   level > 0 ? short_number(level, 7) : no_value, missing_text(results.cells, series)});
  }
  return table;
}

Table relax_table(const ScaleResults& results) {
  Table table({"links", "order", "arithmetic", "threads", "frames/s", "µs a frame", "median", "ns per rod",
               "stretch RMS", "stretch max"});
  for (const ScaleCell& r : results.cells) {
    if (r.series.method != Method::relax || !r.measured()) continue;
    table.add_row({std::to_string(r.links), std::string(to_string(r.series.order)),
                   std::string(to_string(r.series.precision)), std::to_string(r.threads),
                   plain_number(r.frames_per_s()), plain_number(1e6 * r.least_s),
                   plain_number(1e6 * r.median_s), plain_number(r.ns_per_rod()),
                   is_whole(r) ? plain_number(100 * r.stretch.rms) + " %" : no_value,
                   is_whole(r) ? plain_number(100 * r.stretch.max) + " %" : no_value});
  }
  return table;
}

Table five_links_table(const ScaleResults& results) {
  Table table({"five links", "thesis, frames/s", "here, frames/s", "stretch RMS"});
  for (const ScaleCell& r : results.five) {
    table.add_row({std::to_string(r.sweeps) + " sweeps, " + std::string(to_string(r.series.precision)),
                   r.sweeps == 5 ? "597" : "30", r.measured() ? plain_number(r.frames_per_s()) : no_value,
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
      row.push_back(met ? plain_number(1e3 * it->cheapest->ms / links) : no_value);
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
                   best ? best->setting : no_value, best ? plain_number(best->ms) : no_value,
                   best ? plain_number(100 * best->error) + " %" : no_value});
  }
  return table;
}

}  // namespace plumb::tools
