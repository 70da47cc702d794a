#include "scale/results.hpp"

#include <algorithm>

#include "scenes/basics/lists.hpp"
#include "scenes/basics/numbers.hpp"
#include "scenes/runs/report.hpp"

namespace plumb::tools {

using scenes::append_item;
using scenes::short_number;

namespace {

/// Whether the cell is relaxed: only sweeps have a number and an order.
bool is_relaxed(const ScaleCell& cell) {
  return cell.series.method == Method::relax;
}

}  // namespace

std::vector<ScaleSeries> measured_series(const ScaleOptions& options, const ScaleResults& results) {
  std::vector<ScaleSeries> out = all_series(options);
  std::erase_if(out, [&](const ScaleSeries& series) { return timings_of(results.cells, series).empty(); });
  return out;
}

bool is_whole(const ScaleCell& cell) {
  return cell.measured() && cell.frames == scale_frames;
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

std::vector<std::uint32_t> error_links_of(ChainFamily family, const ScaleOptions& options) {
  std::vector<std::uint32_t> out = options.error_links;
  if (family == ChainFamily::equal_length)
    for (std::uint32_t& links : out) links = std::min(links, options.most_fine);
  out.erase(std::unique(out.begin(), out.end()), out.end());
  return out;
}

std::string scale_csv(const ScaleResults& results) {
  std::string csv =
      "links,method,sweeps,order,substeps,precision,threads,frames,least_s,median_s,frames_per_s,ns_per_rod,"
      "stretch_rms,stretch_max,"
      "state_hash\n";
  for (const ScaleCell& r : results.cells) {
    if (!r.measured()) continue;
    std::string line = std::to_string(r.links) + "," + std::string(to_string(r.series.method)) + "," +
                       (is_relaxed(r) ? std::to_string(r.sweeps) : "") + "," +
                       (is_relaxed(r) ? std::string(to_string(r.series.order)) : "") + "," +
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
                         {"sweeps", is_relaxed(r) ? scenes::Json(r.sweeps) : nullptr},
                         {"order", is_relaxed(r) ? scenes::Json(to_string(r.series.order)) : nullptr},
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
