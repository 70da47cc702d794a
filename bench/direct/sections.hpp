#pragma once

#include <cstdint>
#include <string>

namespace plumb::bench {

struct Plan {
  bool full = false;
  std::uint32_t rounds = 25;
};

/// Holds tables as Markdown, and the same numbers as rows of CSV.
struct Section {
  std::string text, csv;
  Section& operator+=(const Section& other) {
    text += other.text;
    csv += other.csv;
    return *this;
  }
};

/// Every row has a section, a scene, a target or contestant, what was measured, its value and unit, and a
/// setting.
inline constexpr const char* csv_header = "section,scene,case,quantity,value,unit,setting\n";

Section lanes_section(const Plan& plan);
Section line_section(const Plan& plan);
/// Measures Newton steps of chains whose rods give beside those of rigid ones.
Section laws_section(const Plan& plan);
/// Measures Newton steps of wires with bends, twisted or not, as lines in lanes and as islands of any shape.
Section wires_section(const Plan& plan);
/// Measures time to an error for chains: fixed settings, automatic, ensembles and other libraries. It also
/// measures relaxation on the longest chain.
Section targets_section(const Plan& plan);
/// Measures time to an error for scenes with loops, against relaxation.
Section loops_section(const Plan& plan);

}  // namespace plumb::bench
