#pragma once

#include <cstdint>
#include <string>

#include "plumb/scene.hpp"
#include "scenes/runs/machine.hpp"
#include "scenes/runs/run.hpp"

namespace plumb::tools {

/// Spells a count with its noun, such as "1 rod" and "2 rods".
std::string plural(std::uint64_t n, const char* noun);

/// Says which rod starts farthest off its length. It is empty if all start there.
std::string start_text(const Scene& scene);
/// Says how much of a scene with ground has no shape to touch it with. It is empty if all is well.
std::string shapeless_text(const Scene& scene);

/// Prints what a run of a scene did, how wrong it was and how long it took, a line for each.
void print_run_summary(const std::string& name, const Scene& scene, const scenes::RunPlan& plan,
                       const scenes::RunResult& result, const scenes::Machine& machine);

}  // namespace plumb::tools
