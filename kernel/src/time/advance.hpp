#pragma once

#include <cstdint>
#include <optional>

#include "interface/solver.hpp"
#include "time/budget.hpp"

namespace plumb::detail {

/// Says what substeps a step of the world takes, for every solver.
struct TimeRules {
  std::uint32_t substeps = 1;            ///< substeps of a step; the fewest if an accuracy is set
  std::optional<double> error_growth{};  ///< m/s that the estimated error of positions may grow by
  std::uint64_t most_work = 1;           ///< work of an island in a step (Settings::most_work)
  Budget::Time deadline{};               ///< of a step with a budget: see Budget::deadline()
};

/// Takes a piece of a solver through a step of `dt` (s), by equal substeps or by as many as its error
/// estimate asks for. Adds what it took to `report`. A piece whose work is spent takes the fewest substeps,
/// each as simply as its solver can.
void advance_piece(Solver& solver, std::uint32_t piece, double dt, const TimeRules& rules, unsigned part,
                   StepReport& report);

}  // namespace plumb::detail
