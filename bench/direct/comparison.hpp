#pragma once

#include <optional>
#include <string>
#include <vector>

#include "direct/search.hpp"
#include "direct/sections.hpp"
#include "support/sheet.hpp"

/// This file compares method direct with relaxation, and writes the lines of CSV for both.
namespace plumb::bench {

/// Returns a cell of a sheet. It is empty where there is nothing.
std::string number(double value);
std::string ratio(double above, double below);

/// Names what a time was measured of.
struct Subject {
  const char* section;
  std::string scene;
  std::string target;
};

void append_csv(std::string& csv, const Subject& subject, const std::string& what, double ms,
                const std::string& setting);

/// Compares direct with plain and over-relaxed relaxation at one error.
struct Comparison {
  std::string scene;
  double error = 0;
  double truth_error = 0;
  std::optional<Trial> direct{};
  Effort plain{}, over{};
  double plain_scalar_ms = 0,
         over_scalar_ms = 0;  ///< rod after rod, one number at a time; 0 if not asked for
};

Comparison compare(const Problem& problem, double error, const Plan& plan, double direct_s, bool by_lines);

/// Returns what an effort takes without vectors (ms), from its last run with them and without.
double scalar_ms(const Problem& problem, const Effort& effort);

/// Returns an effort as text: "out of reach" if it is, with "~" if it is extrapolated.
std::string effort_text(const Effort& effort);

/// Says how an effort's last run was made, and how wrong it was.
std::string effort_setting(const Effort& effort);

Sheet comparison_sheet(const std::vector<Comparison>& comparisons);
/// This text says what the sheet's columns mean.
extern const char* const comparison_text;

void append_csv(std::string& csv, const char* section, const Comparison& c);

/// Returns how many times as long `above` takes as `below`, or 0 if there is nothing to compare with.
double over(double above, const std::optional<Trial>& below);

}  // namespace plumb::bench
