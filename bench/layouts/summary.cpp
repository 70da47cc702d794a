#include "layouts/summary.hpp"

#include <algorithm>

#include "scenes/basics/numbers.hpp"
#include "scenes/runs/report.hpp"
#include "support/statistics.hpp"

namespace plumb::bench {
namespace {

using scenes::plain_number;
using scenes::short_number;

/// Calls f(contest, index, contender) for every listed contender that was measured.
template <class F>
void for_listed(const std::vector<std::shared_ptr<Contest>>& contests, F&& f) {
  for (const auto& contest : contests) {
    if (!contest->is_measured()) continue;
    const auto& contenders = contest->contenders();
    for (std::size_t i = 0; i < contenders.size(); ++i)
      if (contenders[i].listed) f(*contest, i, contenders[i]);
  }
}

/// Returns a number as text, or nothing for one that was not measured.
std::string number(double value) {
  return value == 0 ? "" : plain_number(value);
}
std::string percent(double share) {
  return share == 0 ? "" : plain_number(100 * share, 2) + " %";
}
std::string exact(double value) {
  return value == 0 ? "" : short_number(value, 9);
}

Sheet auto_sheet(const std::vector<std::shared_ptr<Contest>>& contests, const Limits& limits) {
  Sheet sheet({"scene", "size", "fits", "numbers", "threads", "ns", "median", "sweep alone", "baseline",
               "speedup", "speedup, colored", "of compute", "of bandwidth", "stretch", "its baseline's"});
  for_listed(contests, [&](const Contest& contest, std::size_t i, const Contender& contender) {
    if (contender.is_baseline || contender.layout != LayoutChoice::automatic || contender.isa != best_isa())
      return;
    const Case& c = contest.scene_case();
    const Outcome& outcome = contender.outcome;
    const Outcome& base = contest.contenders().front().outcome;
    const Reached share = reached(outcome, contender, c, limits);
    const std::string threads =
        outcome.threads == contender.threads ? "" : " (" + std::to_string(outcome.threads) + " worked)";
    sheet.add_row({std::string(to_string(c.shape)), size_name(c), std::string(to_string(c.level)),
                   std::string(number_name(c.precision)), std::to_string(contender.threads) + threads,
                   number(outcome.least_ns()), number(outcome.median_ns()), number(outcome.median_sweep_ns()),
                   number(base.least_ns()), number(contest.median_speedup(i, "natural")),
                   number(contest.median_speedup(i, "colored")), percent(share.compute),
                   percent(share.bandwidth), percent(outcome.run_up_stretch), percent(base.run_up_stretch)});
  });
  return sheet;
}

Sheet variants_sheet(const std::vector<std::shared_ptr<Contest>>& contests) {
  Sheet sheet({"scene", "size", "numbers", "layout", "instructions", "threads", "ns", "median", "sweep alone",
               "speedup"});
  for_listed(contests, [&](const Contest& contest, std::size_t i, const Contender& contender) {
    if (contender.is_baseline || contest.scene_case().extra) return;
    const Case& c = contest.scene_case();
    const Outcome& outcome = contender.outcome;
    const bool is_variant = contender.layout != LayoutChoice::automatic || contender.isa != best_isa();
    if (!is_variant && (c.level != Level::l2 || contender.threads != 1)) return;
    sheet.add_row({std::string(to_string(c.shape)), size_name(c), std::string(number_name(c.precision)),
                   contender.arrangement, std::string(to_string(contender.isa)),
                   std::to_string(contender.threads), number(outcome.least_ns()), number(outcome.median_ns()),
                   number(outcome.median_sweep_ns()), number(contest.median_speedup(i, "natural"))});
  });
  return sheet;
}

Sheet baselines_sheet(const std::vector<std::shared_ptr<Contest>>& contests) {
  Sheet sheet({"scene", "size", "fits", "numbers", "order", "ns", "median", "stretch"});
  for_listed(contests, [&](const Contest& contest, std::size_t, const Contender& contender) {
    if (!contender.is_baseline) return;
    const Case& c = contest.scene_case();
    const Outcome& outcome = contender.outcome;
    sheet.add_row({std::string(to_string(c.shape)), size_name(c), std::string(to_string(c.level)),
                   std::string(number_name(c.precision)), contender.arrangement, number(outcome.least_ns()),
                   number(outcome.median_ns()), percent(outcome.run_up_stretch)});
  });
  return sheet;
}

Sheet limits_sheet(const Limits& limits) {
  Sheet sheet({"limit", "best", "median", "unit"});
  for (const Limits::Row& row : limits.rows()) {
    if (row.samples.empty()) continue;
    const double best =
        row.is_bandwidth ? *std::max_element(row.samples.begin(), row.samples.end()) : least(row.samples);
    const double scale = row.is_bandwidth ? 1e-9 : 1;
    sheet.add_row({row.name, number(scale * best), number(scale * median(row.samples)),
                   row.is_bandwidth ? "GB/s" : "ns"});
  }
  return sheet;
}

void append_section(std::string& out, const std::string& title, const Sheet& sheet) {
  if (!sheet.empty()) out += "### " + title + "\n\n" + sheet.to_markdown() + "\n";
}

}  // namespace

Reached reached(const Outcome& outcome, const Contender& contender, const Case& c, const Limits& limits) {
  const double ns = outcome.least_ns();
  const double compute_ns = limits.projection_ns(c.precision, contender.isa) / outcome.threads;
  const double memory_ns = 1e9 * outcome.bytes_per_sweep / limits.bytes_per_second(c.level, outcome.threads);
  return {compute_ns / ns, memory_ns / ns};
}

namespace {

const std::vector<std::string> full_columns{"name",
                                            "kind",
                                            "shape",
                                            "precision",
                                            "arrangement",
                                            "isa",
                                            "threads",
                                            "threads_working",
                                            "size",
                                            "level",
                                            "rods",
                                            "bytes",
                                            "sweeps",
                                            "samples",
                                            "ns_min",
                                            "ns_median",
                                            "sweep_ns_median",
                                            "speedup",
                                            "speedup_colored",
                                            "fraction_of_compute_limit",
                                            "fraction_of_bandwidth_limit",
                                            "run_up_steps",
                                            "run_up_stretch",
                                            "steps",
                                            "max_stretch",
                                            "state_hash"};

std::vector<std::string> full_row(const Contest& contest, std::size_t i, const Contender& contender,
                                  const Limits& limits) {
  const Case& c = contest.scene_case();
  const Outcome& outcome = contender.outcome;
  const bool is_world = !contender.is_baseline;
  const Reached share = is_world ? reached(outcome, contender, c, limits) : Reached{};
  return {contender.name(c),
          is_world ? "relax" : "baseline",
          std::string(to_string(c.shape)),
          std::string(number_name(c.precision)),
          contender.arrangement,
          is_world ? std::string(to_string(contender.isa)) : "",
          std::to_string(contender.threads),
          std::to_string(outcome.threads),
          size_name(c),
          std::string(to_string(c.level)),
          std::to_string(outcome.rods),
          is_world ? std::to_string(outcome.bytes) : "",
          std::to_string(sweeps),
          std::to_string(outcome.step_s.size()),
          exact(outcome.least_ns()),
          exact(outcome.median_ns()),
          exact(outcome.median_sweep_ns()),
          exact(contest.median_speedup(i, "natural")),
          exact(contest.median_speedup(i, "colored")),
          exact(share.compute),
          exact(share.bandwidth),
          std::to_string(outcome.run_up_steps),
          exact(outcome.run_up_stretch),
          std::to_string(outcome.steps),
          exact(outcome.max_stretch),
          is_world ? scenes::hash_text(outcome.state_hash) : ""};
}

}  // namespace

Sheet full_sheet(const std::vector<std::shared_ptr<Contest>>& contests, const Limits& limits) {
  Sheet sheet(full_columns);
  for_listed(contests, [&](const Contest& contest, std::size_t i, const Contender& contender) {
    sheet.add_row(full_row(contest, i, contender, limits));
  });
  return sheet;
}

std::string summary_text(const std::vector<std::shared_ptr<Contest>>& contests, const Limits& limits) {
  std::string out;
  append_section(out, "Layout auto, best instruction set", auto_sheet(contests, limits));
  append_section(out, "Layouts and instruction sets", variants_sheet(contests));
  append_section(out, "Baselines", baselines_sheet(contests));
  append_section(out, "Limits of the machine", limits_sheet(limits));
  return out;
}

}  // namespace plumb::bench
