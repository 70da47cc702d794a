#pragma once

#include <algorithm>
#include <vector>

namespace plumb::bench {

inline double least(const std::vector<double>& samples) {
  return *std::min_element(samples.begin(), samples.end());
}

/// Returns the median. Of an even number of samples it is the mean of the two in the middle.
inline double median(std::vector<double> samples) {
  std::sort(samples.begin(), samples.end());
  const std::size_t n = samples.size();
  return n % 2 == 1 ? samples[n / 2] : 0.5 * (samples[n / 2 - 1] + samples[n / 2]);
}

}  // namespace plumb::bench
