#pragma once

#include <cmath>
#include <string>

#include "scenes/basics/numbers.hpp"
#include "support/sheet.hpp"

namespace plumb::bench {

/// Keeps the worst of many ratios that share a goal.
struct Worst {
  double value = 0;
  std::string where{};
  int count = 0, met = 0;

  void add(double ratio, bool is_met, bool is_worse, const std::string& name) {
    if (count == 0 || is_worse) {
      value = ratio;
      where = name;
    }
    ++count;
    met += is_met;
  }
  std::string text() const {
    return std::to_string(met) + " of " + std::to_string(count) + " meet it; worst: " + where;
  }
};

/// Lists goals beside what was measured.
class Goals {
 public:
  void at_least(const std::string& what, double value, double goal) {
    add(what, value, goal, "at least ", value >= goal);
  }
  void at_most(const std::string& what, double value, double goal) {
    add(what, value, goal, "at most ", value <= goal);
  }
  std::string to_markdown() const { return sheet_.to_markdown(); }

 private:
  void add(const std::string& what, double value, double goal, const char* bound, bool met) {
    const std::string measured = std::isfinite(value) ? scenes::plain_number(value) : "none";
    if (goal == 0) return sheet_.add_row({what, measured, "", ""});
    sheet_.add_row({what, measured, bound + scenes::short_number(goal), met ? "met" : "missed"});
  }

  Sheet sheet_{{"goal", "measured", "wanted", ""}};
};

}  // namespace plumb::bench
