#include "profile/output.hpp"

#include <charconv>
#include <cmath>

#include "scenes/basics/lists.hpp"
#include "scenes/basics/numbers.hpp"

namespace plumb::tools {
namespace {

constexpr const char* lost_in_noise = "not measurable under this noise";

std::string level_name(const Cache& cache) {
  std::string name("L");
  return name += std::to_string(cache.level);
}

bool is_relaxed(const ProfileRow& row) {
  return row.profile_case.plan.settings.method == Method::relax;
}

/// Returns the bytes that misses move into the last cache looked at, per unit. Misses move whole lines.
std::optional<double> ll_bytes(const ProfileRow& row, const CachePair& caches) {
  if (!row.counts.ll_misses) return {};
  // Less than a thousandth of a miss is the noise of start-up, and may be below zero.
  return std::abs(*row.counts.ll_misses) < 5e-4 ? 0 : *row.counts.ll_misses * caches.last.line;
}

/// Returns the caches that the counts are about.
const CachePair& counted_caches(const Profile& profile) {
  return profile.way == Way::cachegrind ? profile.simulated : profile.caches;
}

void append_counts(std::vector<std::string>& cells, const ProfileRow& row, const CachePair& caches) {
  const Counts& c = row.counts;
  cells.insert(cells.end(),
               {row.ns ? number_cell(row.ns) : lost_in_noise, number_cell(c.instructions),
                number_cell(c.cycles), count_cell(c.l1d_read_misses), count_cell(c.l1d_write_misses),
                count_cell(c.ll_misses), number_cell(ll_bytes(row, caches))});
}

std::vector<std::string> count_headers() {
  return {"ns", "instructions", "cycles", "L1D read misses", "L1D write misses", "LL misses", "LL bytes"};
}

std::string csv_number(const std::optional<double>& value) {
  return value ? scenes::short_number(*value, 9) : std::string();
}

scenes::Json cache_json(const Cache& cache) {
  return {{"level", cache.level}, {"bytes", cache.bytes}, {"ways", cache.ways}, {"line", cache.line}};
}

scenes::Json row_json(const ProfileRow& row, const CachePair& caches) {
  const Settings& settings = row.profile_case.plan.settings;
  return {{"method", std::string(to_string(settings.method))},
          {"gradient", std::string(to_string(gradient_of(settings)))},
          {"order", is_relaxed(row) ? scenes::Json(to_string(settings.order)) : nullptr},
          {"shape", row.profile_case.shape},
          {"scene", row.profile_case.plan.scene},
          {"fits", size_name(row.profile_case.size, caches)},
          {"layout", row.layout.empty() ? nullptr : scenes::Json(row.layout)},
          {"auto", row.layout.empty() ? nullptr : scenes::Json(row.is_auto)},
          {"rods", row.rods},
          {"state_bytes", row.state_bytes},
          {"model_bytes", row.model_bytes},
          {"ns", row.ns},
          {"instructions", row.counts.instructions},
          {"cycles", row.counts.cycles},
          {"l1d_read_misses", row.counts.l1d_read_misses},
          {"l1d_write_misses", row.counts.l1d_write_misses},
          {"ll_misses", row.counts.ll_misses}};
}

}  // namespace

std::string count_cell(const std::optional<double>& value) {
  if (!value) return no_value;
  char buffer[400];
  const auto result = std::to_chars(buffer, buffer + sizeof buffer, *value, std::chars_format::fixed, 3);
  const std::string text(buffer, result.ptr);
  return text == "-0.000" ? "0.000" : text;
}

std::string number_cell(const std::optional<double>& value) {
  if (!value) return no_value;
  // Start-up differs by a few misses from run to run. Divided by many units that is no number to read.
  return *value < 5e-4 && *value > -5e-4 ? count_cell(value) : scenes::plain_number(*value);
}

std::string size_name(SceneSize size, const CachePair& caches) {
  switch (size) {
    case SceneSize::first_cache:
      return level_name(caches.first);
    case SceneSize::last_cache:
      return level_name(caches.last);
    case SceneSize::beyond:
      break;
  }
  std::string name("> ");
  return name += level_name(caches.last);
}

Table relax_table(const Profile& profile) {
  std::vector<std::string> header{"scene", "fits", "order", "layout", "state, kB", "bytes"};
  const auto counts = count_headers();
  header.insert(header.end(), counts.begin(), counts.end());
  Table table(header);
  for (const ProfileRow& row : profile.rows) {
    if (!is_relaxed(row)) continue;
    std::vector<std::string> cells{
        row.profile_case.plan.scene,
        size_name(row.profile_case.size, profile.caches),
        std::string(to_string(row.profile_case.plan.settings.order)),
        row.layout + (row.is_auto ? " (auto)" : ""),
        row.state_bytes ? scenes::plain_number(static_cast<double>(*row.state_bytes) / 1024) : no_value,
        scenes::plain_number(row.model_bytes)};
    append_counts(cells, row, counted_caches(profile));
    table.add_row(cells);
  }
  return table;
}

Table direct_table(const Profile& profile) {
  std::vector<std::string> header{"scene", "fits", "gradient", "bytes"};
  const auto counts = count_headers();
  header.insert(header.end(), counts.begin(), counts.end());
  Table table(header);
  for (const ProfileRow& row : profile.rows) {
    if (is_relaxed(row)) continue;
    std::vector<std::string> cells{row.profile_case.plan.scene,
                                   size_name(row.profile_case.size, profile.caches),
                                   std::string(to_string(gradient_of(row.profile_case.plan.settings))),
                                   scenes::plain_number(row.model_bytes)};
    append_counts(cells, row, counted_caches(profile));
    table.add_row(cells);
  }
  return table;
}

std::string way_text(const Profile& profile) {
  const std::string caches = "L1D: " + describe(profile.caches.first) +
                             "; LL, the last cache looked at: " + level_name(profile.caches.last) + ", " +
                             describe(profile.caches.last) +
                             (profile.caches.assumed ? " (assumed: the system does not tell). " : ". ");
  std::string text;
  switch (profile.way) {
    case Way::counters:
      text = "Measured with the processor's counters, one thread, user space. " + caches +
             "What a prefetcher fetched in time is no miss, and what it fetched in vain may be one.";
      break;
    case Way::cachegrind:
      text =
          "Simulated by cachegrind, one thread. " + caches +
          "Simulated are L1D: " + describe(profile.simulated.first) +
          ", and LL: " + describe(profile.simulated.last) +
          ". Its caches keep what was used last, do not fetch ahead, and do not count what is written back. "
          "Misses of two runs, one with twice as many sweeps (or frames), are subtracted, so that set-up "
          "does not count. Cycles are not simulated.";
      break;
    case Way::none:
      text = caches;
      break;
  }
  if (!profile.remark.empty()) text += " " + profile.remark;
  return text;
}

std::string profile_csv(const Profile& profile) {
  std::string csv =
      "way,method,gradient,order,shape,scene,fits,layout,auto,precision,isa,rods,state_bytes,model_bytes,ns,"
      "instructions,cycles,l1d_read_misses,l1d_write_misses,ll_misses\n";
  for (const ProfileRow& row : profile.rows) {
    const Settings& settings = row.profile_case.plan.settings;
    // The scene is quoted because it has commas of its own.
    std::string line(to_string(profile.way));
    for (const std::string& item :
         {std::string(to_string(settings.method)), std::string(to_string(gradient_of(settings))),
          is_relaxed(row) ? std::string(to_string(settings.order)) : std::string(), row.profile_case.shape,
          "\"" + row.profile_case.plan.scene + "\"", size_name(row.profile_case.size, profile.caches),
          row.layout,
          std::string(row.layout.empty() ? ""
                      : row.is_auto      ? "1"
                                         : "0"),
          std::string(to_string(profile.precision)), std::string(to_string(profile.isa)),
          std::to_string(row.rods), row.state_bytes ? std::to_string(*row.state_bytes) : std::string(),
          csv_number(row.model_bytes), csv_number(row.ns), csv_number(row.counts.instructions),
          csv_number(row.counts.cycles), csv_number(row.counts.l1d_read_misses),
          csv_number(row.counts.l1d_write_misses), csv_number(row.counts.ll_misses)}) {
      scenes::append_item(line, item, ",");
    }
    csv += line + "\n";
  }
  return csv;
}

scenes::Json profile_json(const Profile& profile) {
  scenes::Json json{{"way", std::string(to_string(profile.way))}};
  json["remark"] = profile.remark;
  json["precision"] = std::string(to_string(profile.precision));
  json["isa"] = std::string(to_string(profile.isa));
  json["caches"] = {{"l1d", cache_json(profile.caches.first)},
                    {"ll", cache_json(profile.caches.last)},
                    {"assumed", profile.caches.assumed}};
  json["simulated"] = nullptr;
  if (profile.way == Way::cachegrind)
    json["simulated"] = {{"l1d", cache_json(profile.simulated.first)},
                         {"ll", cache_json(profile.simulated.last)}};
  scenes::Json rows = scenes::Json::array();
  for (const ProfileRow& row : profile.rows) rows.push_back(row_json(row, profile.caches));
  json["rows"] = rows;
  return json;
}

}  // namespace plumb::tools
