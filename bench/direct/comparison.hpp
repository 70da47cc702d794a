#pragma once

#include <optional>
#include <string>
#include <vector>

#include "direct/search.hpp"
#include "direct/sections.hpp"
#include "support/sheet.hpp"

/// Method direct beside relaxation, and the lines of CSV for both.
namespace plumb::bench {

/// Cells of a sheet; empty where there is nothing.
std::string number(double value);
std::string ratio(double above, double below);

/// What a time was measured of.
struct Subject {
  const char* section;
  std::string scene;
  std::string target;
};

void append_csv(std::string& csv, const Subject& subject, const std::string& what, double ms,
                const std::string& setting);

/// Direct against plain and over-relaxed relaxation at one error.
struct Comparison {
  std::string scene;
  double error = 0;
  double truth_error = 0;
  std::optional<Trial> direct{};
  Effort plain{}, over{};
  double plain_scalar_ms = 0, over_scalar_ms = 0;  ///< rod after rod, one number at a time; 0: not asked for
};

Comparison compare(const Problem& problem, double error, const Plan& plan, double direct_s, bool by_lines);

/// What an effort takes without vectors, from its last run with them and without.
double scalar_ms(const Problem& problem, const Effort& effort);

/// "out of reach" if it is, with "~" if it is extrapolated.
std::string effort_text(const Effort& effort);

/// How its last run was made, and how wrong it was.
std::string effort_setting(const Effort& effort);

Sheet comparison_sheet(const std::vector<Comparison>& comparisons);
/// What the sheet's columns mean.
extern const char* const comparison_text;

void append_csv(std::string& csv, const char* section, const Comparison& c);

/// How many times as long; 0 if there is nothing to compare with.
double over(double above, const std::optional<Trial>& below);

}  // namespace plumb::bench
