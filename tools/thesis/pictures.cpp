#include "thesis/pictures.hpp"

#include <cmath>

#include "scenes/basics/numbers.hpp"
#include "thesis/stiff_equations.hpp"

namespace plumb::tools {
namespace {

using scenes::plain_number;
using scenes::short_number;

constexpr double spring_stiffness =
    1000;  // Stiffness k of eq. 3.13, in 1/s. What is shown depends on h k alone.
constexpr int stiff_steps = 20;
constexpr double velocity_duration = 10;  // Simulated time of the velocities, in s.

struct StiffCase {
  bool implicit = false;
  double hk = 0;
  const char* color = "";
};
const std::vector<StiffCase> stiff_cases = {{false, 0.5, "#2a9d5c"}, {false, 1.5, "#1f5fa8"},
                                            {false, 2, "#e08e2b"},   {false, 2.1, "#d1495b"},
                                            {true, 2.1, "#7b4fb5"},  {true, 100, "#333333"}};

std::string name_of(const StiffCase& c) {
  return std::string(c.implicit ? "backward" : "forward") + " Euler, hk = " + short_number(c.hk);
}

/// Returns y after each of some steps, the start included.
std::vector<double> follow(const StiffCase& c, int steps) {
  StiffState state;
  std::vector<double> out{state.y};
  const double h = c.hk / spring_stiffness;
  for (int i = 0; i < steps; ++i) {
    state =
        c.implicit ? implicit_step(state, spring_stiffness, h) : explicit_step(state, spring_stiffness, h);
    out.push_back(state.y);
  }
  return out;
}

struct VelocityCase {
  VelocityScheme scheme;
  const char* name;
  const char* color;
};
const std::vector<VelocityCase> velocity_cases = {
    {VelocityScheme::rk2, "Runge-Kutta 2", "#2a9d5c"},
    {VelocityScheme::verlet_backward, "Verlet, (x - x*)/h", "#d1495b"},
    {VelocityScheme::verlet_central, "Verlet, central", "#1f5fa8"}};

const std::vector<double> velocity_steps = {0.5, 0.2, 0.1, 0.05, 0.02, 0.01, 0.005, 0.002, 0.001};

double error_of(const VelocityCase& c, double h) {
  return velocity_error(c.scheme, h, velocity_duration);
}

/// Returns the power of the step with which errors fall, at the finer end.
double order_of(const VelocityCase& c) {
  const double fine = velocity_steps.back(), coarse = velocity_steps[velocity_steps.size() - 2];
  return std::log(error_of(c, coarse) / error_of(c, fine)) / std::log(coarse / fine);
}

}  // namespace

Chart stiff_chart() {
  Chart chart{.title = "y' = -k y (eq. 3.13), step after step",
              .x = "steps",
              .y = "y",
              .series = {},
              .log_x = false,
              .log_y = false};
  for (const StiffCase& c : stiff_cases) {
    Series series{.name = name_of(c), .color = c.color, .dashed = c.implicit};
    const std::vector<double> values = follow(c, stiff_steps);
    for (std::size_t i = 0; i < values.size(); ++i)
      series.points.emplace_back(static_cast<double>(i), values[i]);
    chart.series.push_back(series);
  }
  return chart;
}

Chart amplification_chart() {
  Chart chart{
      .title = "what a step does to |y|", .x = "hk", .y = "|y| after a step over before", .series = {}};
  Series forward{.name = "forward Euler, |1 - hk|", .color = "#d1495b"};
  Series backward{.name = "backward Euler, 1/(1 + hk)", .color = "#333333"};
  Series limit{.name = "stable below (eq. 3.15)", .color = "#bbbbbb", .dashed = true};
  // A factor of ten takes 12 steps, none of which meets hk = 1, where forward Euler leaves nothing.
  for (int i = -24; i < 36; ++i) {
    const double hk = std::pow(10, (i + 0.5) / 12);
    forward.points.emplace_back(hk, std::abs(follow({.implicit = false, .hk = hk}, 1).back()));
    backward.points.emplace_back(hk, std::abs(follow({.implicit = true, .hk = hk}, 1).back()));
  }
  limit.points = {{forward.points.front().first, 1}, {forward.points.back().first, 1}};
  chart.series = {forward, backward, limit};
  return chart;
}

Table stiff_table() {
  Table table(
      {"integrator", "hk", "factor a step", "|y| after " + std::to_string(stiff_steps) + " steps", "stable"});
  for (const StiffCase& c : stiff_cases) {
    const std::vector<double> values = follow(c, stiff_steps);
    // A factor of 1, at hk = 2, neither grows nor dies away, which is not stable. The limit leaves room for
    // rounding.
    const bool stable = std::abs(values[1]) < 1 - 1e-12;
    table.add_row({c.implicit ? "backward Euler" : "forward Euler", short_number(c.hk),
                   short_number(values[1], 4), short_number(std::abs(values.back()), 3),
                   stable ? "yes" : "no"});
  }
  return table;
}

Chart velocity_chart() {
  Chart chart{.title = "velocity on a spring (figure 3.12): largest error over " +
                       short_number(velocity_duration) + " s",
              .x = "step h, s",
              .y = "m/s",
              .series = {}};
  for (const VelocityCase& c : velocity_cases) {
    Series series{.name = c.name, .color = c.color};
    for (const double h : velocity_steps) series.points.emplace_back(h, error_of(c, h));
    chart.series.push_back(series);
  }
  return chart;
}

Table velocity_table() {
  std::vector<std::string> header{"velocity error, m/s"};
  for (const double h : velocity_steps) header.push_back("h = " + short_number(h) + " s");
  header.emplace_back("order");
  Table table(header);
  for (const VelocityCase& c : velocity_cases) {
    std::vector<std::string> row{c.name};
    for (const double h : velocity_steps) row.push_back(short_number(error_of(c, h), 2));
    row.push_back(plain_number(order_of(c)));
    table.add_row(row);
  }
  return table;
}

std::string velocity_text() {
  const double h = 0.01;
  const double rk2 = error_of(velocity_cases[0], h), backward = error_of(velocity_cases[1], h),
               central = error_of(velocity_cases[2], h);
  return "A particle on a spring, x'' = -x, for " + short_number(velocity_duration) +
         " s. Section 3.2 finds velocities of Runge-Kutta 2 more precise than those of Verlet. In steps of " +
         short_number(h) + " s the velocity that Verlet stands for, (x - x*)/h, is off by " +
         short_number(backward, 2) + " m/s, " + plain_number(backward / rk2, 2) +
         " times as much as that of " + "Runge-Kutta 2" + (backward > rk2 ? ": so it is" : ": so it is not") +
         ". But that is the velocity half a step ago; taken over two steps, Verlet's is off by " +
         short_number(central, 2) + " m/s, " + plain_number(central / rk2, 2) + " times.";
}

scenes::Json stiff_json() {
  scenes::Json list = scenes::Json::array();
  for (const StiffCase& c : stiff_cases)
    list.push_back({{"integrator", c.implicit ? "backward Euler" : "forward Euler"},
                    {"hk", c.hk},
                    {"y", scenes::Json::array_of(follow(c, stiff_steps))}});
  return list;
}

scenes::Json velocity_json() {
  scenes::Json list = scenes::Json::array();
  for (const VelocityCase& c : velocity_cases)
    for (const double h : velocity_steps)
      list.push_back({{"scheme", c.name}, {"h", h}, {"error", error_of(c, h)}});
  return list;
}

}  // namespace plumb::tools
