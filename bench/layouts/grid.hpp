#pragma once

#include <cstdint>
#include <memory>
#include <vector>

#include "contest/contest.hpp"

namespace plumb::bench {

/// Returns all contests of a run, in order.
///
/// By default the layout auto takes part with the best instruction set and 1 and 2 threads at every level.
/// Other layouts and instruction sets take part on one thread where scenes fit L2. `full` takes everything
/// everywhere, for hours. A baseline takes part in every contest, and a scalar world is the reference of all
/// bits where scenes fit L2.
std::vector<std::shared_ptr<Contest>> make_contests(bool full, std::uint32_t rounds);

}  // namespace plumb::bench
