#pragma once

#include <string>
#include <vector>

#include "plot/chart.hpp"
#include "plot/table.hpp"
#include "scenes/basics/json.hpp"

/// What integrators do to a stiff equation and to a velocity (thesis sections 3.2 and 3.3), drawn and in
/// numbers.
namespace plumb::tools {

/// y' = -k y (eq. 3.13) from y = 1, step after step: forward Euler at some hk around 2 (eq. 3.15), backward
/// at a large one. Linear axes.
Chart stiff_chart();
/// |y| after a step over |y| before, against hk, of both.
Chart amplification_chart();
/// Steps of hk, factors a step, and |y| after 20 steps.
Table stiff_table();

/// Largest error of a velocity over 10 s against the step (figure 3.12).
Chart velocity_chart();
/// The same in numbers, with the order between the last two steps.
Table velocity_table();
/// Which scheme is the more precise, from the numbers.
std::string velocity_text();

scenes::Json stiff_json();
scenes::Json velocity_json();

}  // namespace plumb::tools
