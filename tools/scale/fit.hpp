#pragma once

#include <cstdint>
#include <optional>
#include <utility>
#include <vector>

/// What can be said of times against sizes, and when to stop measuring them.
namespace plumb::tools {

/// A number of links and seconds, both positive.
using Timing = std::pair<double, double>;

/// The exponent p of time = c · links^p: least squares of log time against log links. None for fewer than two
/// different numbers of links.
std::optional<double> fit_slope(const std::vector<Timing>& timings);
/// The same over the longer half of the lengths (of an odd number, the middle one too), where what a frame
/// costs apart from its links no longer counts. The timings go by ascending links.
std::optional<double> fit_longer_half(const std::vector<Timing>& timings);

/// The most links until which no frame takes more than `factor` times what the shortest chain's does: up to
/// there frames per second are level. The timings go by ascending links; 0 without any.
double level_until(const std::vector<Timing>& timings, double factor);

/// Whether a series of ever larger cells goes on. A cell that took too long ends it, and so does one that
/// would: time is taken to grow with links, no faster, so that nothing is given up that could be measured.
class CellCap {
 public:
  explicit CellCap(double seconds) : seconds_(seconds) {}
  double seconds() const { return seconds_; }  ///< of wall-clock time for a cell
  bool allows(double links) const;
  void spent(double links, double seconds);
  /// The last cell could not be measured: none larger is tried.
  void stop() { stopped_ = true; }

 private:
  double seconds_;
  double last_links_ = 0, last_seconds_ = 0;
  bool stopped_ = false;
};

}  // namespace plumb::tools
