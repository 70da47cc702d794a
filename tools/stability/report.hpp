#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "plot/table.hpp"
#include "stability/picture.hpp"

namespace plumb::tools {

/// Says what was measured, for the terminal and for the page.
struct StabilityReport {
  std::vector<MeasuredGrid> grids;
  std::uint32_t sweeps = 20;
  double budget_s = 2;
  std::string typed;  ///< Options as the user typed them.

  std::string text() const;
  /// Returns a row per scene and method. The worst values are over the cells that survived.
  Table summary() const;
  /// Says why cells did not survive, with a row per scene and method and a column per outcome that occurs.
  Table outcomes() const;
  /// Writes stability.csv, the page and its pictures.
  void publish(const std::string& folder) const;
};

}  // namespace plumb::tools
