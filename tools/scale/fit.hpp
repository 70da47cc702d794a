#pragma once

#include <cstdint>
#include <optional>
#include <utility>
#include <vector>

/// These functions say how times grow with sizes, and when to stop measuring them.
namespace plumb::tools {

/// A number of links and a time in s, both positive.
using Timing = std::pair<double, double>;

/// Returns the exponent p of time = c · links^p, by least squares of log time against log links. There is
/// none for fewer than two different numbers of links.
std::optional<double> fit_slope(const std::vector<Timing>& timings);
/// Returns the exponent over the longer half of the lengths, where what a frame costs apart from its links no
/// longer counts. An odd number of lengths gives the middle one to that half. Timings must be sorted by
/// links.
std::optional<double> fit_longer_half(const std::vector<Timing>& timings);

/// Returns the most links up to which frames per second are level: no frame takes more than `factor` times
/// the shortest chain's. Timings must be sorted by links. Without any it returns 0.
double level_until(const std::vector<Timing>& timings, double factor);

/// Decides whether a series of ever larger cells goes on. A cell that took too long ends it, and so does one
/// that would. Time is taken to grow no faster than links, so that nothing is given up that could be
/// measured.
class CellCap {
 public:
  explicit CellCap(double seconds) : seconds_(seconds) {}
  double seconds() const { return seconds_; }  ///< Wall-clock time that a cell may take, in s.
  bool allows(double links) const;
  void spent(double links, double seconds);
  /// Ends the series: the last cell could not be measured, and none larger is tried.
  void stop() { stopped_ = true; }

 private:
  double seconds_;
  double last_links_ = 0, last_seconds_ = 0;
  bool stopped_ = false;
};

}  // namespace plumb::tools
