#pragma once

#include <cstdint>
#include <memory>
#include <vector>

#include "contest/contest.hpp"

namespace plumb::bench {

/// All contests of a run, in order.
///
/// By default the layout auto with the best instruction set and 1 and 2 threads at every level; other layouts
/// and instruction sets on one thread where scenes fit L2. `full`: everything everywhere, which takes hours.
/// A baseline takes part in every contest, and a scalar world as the reference of all bits where scenes fit
/// L2.
std::vector<std::shared_ptr<Contest>> make_contests(bool full, std::uint32_t rounds);

}  // namespace plumb::bench
