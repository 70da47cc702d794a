#pragma once

#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "plot/table.hpp"
#include "scenes/basics/json.hpp"
#include "thesis/springs.hpp"

/// This table sets what the thesis saw or said of its five links beside what is measured here.
namespace plumb::tools {

/// There is one number for each way to solve. Relative lengths are shares of the chain's, and times are in s.
struct PerWay {
  double truth = 0, mass = 0, equal = 0, springs = 0;
};

/// These are times to rest with the heavy end and with the light one, in s. They are negative if they exceed
/// `limit`.
struct RestTimes {
  double mass = 0, mass_light = 0, equal = 0, equal_light = 0, truth = 0;
  double limit = 0;  ///< Longest simulated time, in s.
};

/// Holds all that the table is made of, for scene thesis5.
struct ThesisNumbers {
  double frames = 600;      ///< Steps of springs per second, as in the thesis.
  double spring_limit = 0;  ///< Predicted limit of forward Euler at those steps, in N/m.
  double stiffness = 0;     ///< Half that limit, in N/m, which is what `springs` stands for.
  PerWay change;            ///< Change of the motion at 1 s if the end weighs 2 kg instead of 1 kg.
  PerWay error;             ///< Errors of positions at 1 s; for the truth, what it is known to.
  double stiff = 0;         ///< Stiffness of springs in steps of 1/60/128 s, in N/m.
  double stiff_error = 0;   ///< Error of those springs.
  /// Times with a drag of 0.5 per second, and without one at 5 sweeps a frame with gradient new.
  RestTimes drag, numerical;
  double link = 0;            ///< Length of a link, in m.
  HangingGaps hanging;        ///< Gaps of the hanging chain with `stiffness`.
  MovingGaps moving;          ///< Gaps of the moving chain with `stiffness`.
  Measured five, thousand;    ///< Relaxation with 5 sweeps in those steps, and with 1000 in steps of 1/60 s.
  double one_percent = 0;     ///< Stiffness with which the top joint opens by 1 % of a link, in N/m.
  double explicit_steps = 0;  ///< Steps per second that forward Euler then needs.
  double semi_implicit_steps = 0;      ///< Steps per second that semi-implicit Euler then needs.
  SpringLimit forward, semi_implicit;  ///< Limits at 602 steps a second.
  double springs_fps = 0, five_fps = 0, thousand_fps = 0;
};
ThesisNumbers measure_thesis_numbers();

/// A row has the thesis's words, ours, and whether they agree.
struct ThesisRow {
  std::string what, thesis, where, ours;
  std::optional<bool> agrees;  ///< Whether they agree; none where the thesis leaves out what it depends on.
  std::vector<std::pair<std::string, double>> values;  ///< Values in SI units, for programs.
};
std::vector<ThesisRow> thesis_rows(const ThesisNumbers& numbers);
Table thesis_table(const std::vector<ThesisRow>& rows);
scenes::Json thesis_rows_json(const std::vector<ThesisRow>& rows);
/// Says how all was measured.
std::string thesis_table_text(const ThesisNumbers& numbers);

}  // namespace plumb::tools
