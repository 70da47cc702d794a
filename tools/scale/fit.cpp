#include "scale/fit.hpp"

#include <algorithm>
#include <cmath>

namespace plumb::tools {

std::optional<double> fit_slope(const std::vector<Timing>& timings) {
  const auto n = static_cast<double>(timings.size());
  double mean_x = 0, mean_y = 0;
  for (const auto& [links, seconds] : timings) {
    mean_x += std::log(links) / n;
    mean_y += std::log(seconds) / n;
  }
  double square = 0, product = 0;
  for (const auto& [links, seconds] : timings) {
    const double x = std::log(links) - mean_x;
    square += x * x;
    product += x * (std::log(seconds) - mean_y);
  }
  if (!(square > 1e-12)) return {};
  return product / square;
}

std::optional<double> fit_longer_half(const std::vector<Timing>& timings) {
  return fit_slope({timings.begin() + static_cast<std::ptrdiff_t>(timings.size() / 2), timings.end()});
}

double level_until(const std::vector<Timing>& timings, double factor) {
  double links = 0;
  for (const auto& [count, seconds] : timings) {
    if (seconds > factor * timings.front().second) break;
    links = count;
  }
  return links;
}

bool CellCap::allows(double links) const {
  if (stopped_) return false;
  return last_links_ == 0 || last_seconds_ * links / last_links_ <= seconds_;
}

void CellCap::spent(double links, double seconds) {
  last_links_ = links;
  last_seconds_ = seconds;
  stopped_ = stopped_ || seconds > seconds_;
}

}  // namespace plumb::tools
