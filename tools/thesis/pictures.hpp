#pragma once

#include <string>
#include <vector>

#include "plot/chart.hpp"
#include "plot/table.hpp"
#include "scenes/basics/json.hpp"

/// These functions draw what integrators do to a stiff equation and to a velocity (thesis sections 3.2
/// and 3.3), and give the numbers.
namespace plumb::tools {

/// Draws y' = -k y (eq. 3.13) from y = 1, step after step, on linear axes. Forward Euler has some hk around 2
/// (eq. 3.15), and backward Euler a large one.
Chart stiff_chart();
/// Draws |y| after a step over |y| before, against hk, for both.
Chart amplification_chart();
/// Lists steps hk, factors a step, and |y| after 20 steps.
Table stiff_table();

/// Draws the largest error of a velocity over 10 s against the step (figure 3.12).
Chart velocity_chart();
/// Lists the same in numbers, with the order between the last two steps.
Table velocity_table();
/// Says which scheme is the more precise, from the numbers.
std::string velocity_text();

scenes::Json stiff_json();
scenes::Json velocity_json();

}  // namespace plumb::tools
