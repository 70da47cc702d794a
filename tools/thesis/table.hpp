#pragma once

#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "plot/table.hpp"
#include "scenes/basics/json.hpp"
#include "thesis/springs.hpp"

/// What the thesis saw or said of its five links, beside what is measured here.
namespace plumb::tools {

/// One number for each way to solve; relative lengths are shares of the chain's, times are seconds.
struct PerWay {
  double truth = 0, mass = 0, equal = 0, springs = 0;
};

/// Times to rest with the heavy end and with the light one; negative: not within `limit`.
struct RestTimes {
  double mass = 0, mass_light = 0, equal = 0, equal_light = 0, truth = 0;
  double limit = 0;  ///< s
};

/// All that the table is made of, for scene thesis5.
struct ThesisNumbers {
  double frames = 600;             ///< steps of springs per second, as in the thesis
  double spring_limit = 0;         ///< N/m, forward Euler's at those steps, predicted
  double stiffness = 0;            ///< N/m, half that limit: what `springs` stands for
  PerWay change;                   ///< of the motion at 1 s if the end weighs 2 kg instead of 1 kg
  PerWay error;                    ///< of positions at 1 s; of the truth, what it is known to
  double stiff = 0;                ///< N/m, of springs in steps of 1/60/128 s
  double stiff_error = 0;          ///< theirs
  RestTimes drag, numerical;       ///< with a drag of 0.5 per second; without, 5 sweeps a frame, gradient new
  double link = 0;                 ///< m
  HangingGaps hanging;             ///< with `stiffness`
  MovingGaps moving;               ///< with `stiffness`
  Measured five, thousand;         ///< relaxed, 5 sweeps in those steps, 1000 in steps of 1/60 s
  double one_percent = 0;          ///< N/m, with which the top joint opens by 1 % of a link
  double explicit_steps = 0;       ///< per second, that forward Euler then needs
  double semi_implicit_steps = 0;  ///< per second, that semi-implicit Euler then needs
  SpringLimit forward, semi_implicit;  ///< at 602 steps a second
  double springs_fps = 0, five_fps = 0, thousand_fps = 0;
};
ThesisNumbers measure_thesis_numbers();

/// A row: the thesis's words, ours, and whether they agree.
struct ThesisRow {
  std::string what, thesis, where, ours;
  std::optional<bool> agrees;  ///< none where the thesis leaves out what it depends on
  std::vector<std::pair<std::string, double>> values;  ///< SI units, for programs
};
std::vector<ThesisRow> thesis_rows(const ThesisNumbers& numbers);
Table thesis_table(const std::vector<ThesisRow>& rows);
scenes::Json thesis_rows_json(const std::vector<ThesisRow>& rows);
/// How all was measured.
std::string thesis_table_text(const ThesisNumbers& numbers);

}  // namespace plumb::tools
