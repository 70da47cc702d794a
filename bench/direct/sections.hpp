#pragma once

#include <cstdint>
#include <string>

namespace plumb::bench {

struct Plan {
  bool full = false;
  std::uint32_t rounds = 25;
};

/// Tables as Markdown, and the same numbers as rows of CSV.
struct Section {
  std::string text, csv;
  Section& operator+=(const Section& other) {
    text += other.text;
    csv += other.csv;
    return *this;
  }
};

/// Of every row: section, scene, target or contestant, what was measured, value, unit, setting.
inline constexpr const char* csv_header = "section,scene,case,quantity,value,unit,setting\n";

Section lanes_section(const Plan& plan);
Section line_section(const Plan& plan);
/// Time to an error for chains: fixed settings, automatic, ensembles, other libraries; and relaxation on the
/// longest chain.
Section targets_section(const Plan& plan);
/// Time to an error for scenes with loops, against relaxation.
Section loops_section(const Plan& plan);

}  // namespace plumb::bench
