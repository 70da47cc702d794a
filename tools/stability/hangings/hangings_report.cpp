#include "stability/hangings/hangings_report.hpp"

#include <algorithm>
#include <cstdio>
#include <map>
#include <string>

#include "cli/commands.hpp"
#include "plot/table.hpp"
#include "scenes/basics/numbers.hpp"
#include "stability/hangings/hangings.hpp"

namespace plumb::tools {
namespace {

using scenes::HangingResult;

/// All hangings of a kind add up to this.
struct Kind {
  std::uint32_t scenes = 0, named = 0, dear = 0, faults = 0;
  StepReport total{};
  double worst_ratio = 0, worst_work = 0;

  void add(const HangingResult& result) {
    ++scenes;
    named += result.named > 0;
    dear += result.is_dear();
    faults += !result.fault().empty();
    total += result.total;
    worst_ratio = std::max(worst_ratio, result.work_ratio());
    worst_work = std::max(worst_work, result.worst_work);
  }
  std::vector<std::string> row(const std::string& name) const {
    return {name,
            std::to_string(scenes),
            std::to_string(faults),
            std::to_string(named),
            std::to_string(total.unsolved),
            std::to_string(total.elastic_substeps),
            std::to_string(dear),
            scenes::short_number(worst_ratio, 3),
            scenes::short_number(worst_work, 6)};
  }
};

}  // namespace

void report_hangings(std::uint32_t count, std::uint32_t seed, double duration) {
  std::map<std::string, Kind> kinds;
  Kind all;
  for (std::uint32_t i = 0; i < count; ++i) {
    const HangingResult result = scenes::hang(std::uint64_t{seed} + i, duration);
    kinds[result.kind].add(result);
    all.add(result);
    const std::string fault = result.fault();
    if (!fault.empty())
      std::printf("seed %u: %s of %u rods: %s\n", seed + i, result.kind.c_str(), result.rods, fault.c_str());
  }
  Table table({"kind", "scenes", "faults", "with problems", "unsolved", "elastic", "dear", "worst ratio",
               "worst work"});
  for (const auto& [name, kind] : kinds) table.add_row(kind.row(name));
  table.add_row(all.row("all"));
  std::printf(
      "%s\nA fault is a position that is not finite, a slack thing that stands still, or a frame that "
      "was neither\nsolved nor named by problems(). Work counts Newton steps, halvings and sweeps of a "
      "frame. A scene is dear\nif its worst frame takes more than %g times the work of its median "
      "one, among frames in which\nsomething moves faster than %g m/s.\n",
      table.to_text().c_str(), HangingResult::dear_ratio, HangingResult::rest);
  if (all.faults > 0) throw CheckFailed(std::to_string(all.faults) + " hangings have faults");
}

}  // namespace plumb::tools
