#pragma once

#include <memory>
#include <string>
#include <vector>

#include "contest/contest.hpp"
#include "limits/limits.hpp"
#include "support/sheet.hpp"

namespace plumb::bench {

/// What a contender reached of the machine's limits, by its least time: the least time that its projections
/// take in registers, on as many threads, over what they took; and the same for a pass over memory per sweep.
/// The second is above 1 where sweeps share passes.
struct Reached {
  double compute = 0;
  double bandwidth = 0;
};
Reached reached(const Outcome& outcome, const Contender& contender, const Case& c, const Limits& limits);

/// Every listed contender of every measured contest with all its numbers.
Sheet full_sheet(const std::vector<std::shared_ptr<Contest>>& contests, const Limits& limits);

/// What people read: Markdown with a table of the layout auto, one of layouts and instruction sets, and the
/// limits.
std::string summary_text(const std::vector<std::shared_ptr<Contest>>& contests, const Limits& limits);

}  // namespace plumb::bench
