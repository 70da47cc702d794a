#pragma once

#include <memory>
#include <string>
#include <vector>

#include "contest/contest.hpp"
#include "limits/limits.hpp"
#include "support/sheet.hpp"

namespace plumb::bench {

/// Says which share of the machine's limits a contender reached in its least time. One limit is the least
/// time of its projections in registers, on as many threads. The other is a pass over memory per sweep; its
/// share is above 1 where sweeps share passes.
struct Reached {
  double compute = 0;
  double bandwidth = 0;
};
Reached reached(const Outcome& outcome, const Contender& contender, const Case& c, const Limits& limits);

/// Returns every listed contender of every measured contest with all its numbers.
Sheet full_sheet(const std::vector<std::shared_ptr<Contest>>& contests, const Limits& limits);

/// Returns what people read: Markdown with a table of the layout auto, one of layouts and instruction sets,
/// and the limits.
std::string summary_text(const std::vector<std::shared_ptr<Contest>>& contests, const Limits& limits);

}  // namespace plumb::bench
