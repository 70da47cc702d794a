#pragma once

#include <cstdint>
#include <string>

#include "scenes/runs/machine.hpp"
#include "scenes/runs/run.hpp"

namespace plumb::tools {

/// Spells a count with its noun, such as "1 rod" and "2 rods".
std::string plural(std::uint64_t n, const char* noun);

/// Prints what a run of `scene` did, how wrong it was and how long it took, a line for each.
void print_run_summary(const std::string& scene, const scenes::RunPlan& plan, const scenes::RunResult& result,
                       const scenes::Machine& machine);

}  // namespace plumb::tools
