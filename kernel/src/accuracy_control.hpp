#pragma once

#include <algorithm>
#include <atomic>
#include <cmath>
#include <cstdint>
#include <limits>

#include "tree_stepper.hpp"

namespace plumb::detail {

/// Steps in as many substeps as keep the estimated error's growth within `allowed`.
struct AccuracyControl {
  double allowed;             ///< m/s
  std::uint32_t least, most;  ///< substeps of a step
  std::uint32_t order;        ///< in time
  bool even;                  ///< whether estimates want an even number of substeps

  /// `substep` (s) is what the last step thought best; 0 if there was none. `advance(h, substeps)` returns
  /// the estimated error of a substep, m; `restore()` takes back what it did.
  template <class Advance, class Restore>
  void step(double dt, double& substep, DirectCounters& counters, Advance&& advance,
            Restore&& restore) const {
    if (substep == 0) substep = dt / first_substeps;
    double last_rate = std::numeric_limits<double>::infinity();
    for (int attempt = 1;; ++attempt) {
      const double wanted = std::ceil(dt / substep);
      auto substeps = static_cast<std::uint32_t>(
          std::clamp(wanted, double{1} * least, double{1} * std::max(most, least)));
      if (even) substeps += substeps % 2;
      const double h = dt / substeps;
      const double rate = advance(h, substeps) / (h * allowed);
      // The error of a step of order p grows by h^p a second.
      substep = h * std::clamp(std::pow(safety / rate, 1.0 / order), slowest_change, fastest_change);
      if (rate <= 1) return;
      // Where rounding is what is estimated, shorter steps make it worse.
      const bool hopeless = attempt > 2 && !(rate < last_rate);
      if (hopeless || attempt == most_attempts || substeps >= most) {
        substep = h;
        counters.inaccurate.fetch_add(1, std::memory_order_relaxed);
        return;
      }
      last_rate = rate;
      restore();
      counters.repeated.fetch_add(1, std::memory_order_relaxed);
    }
  }

  /// Of two runs through the same step, one with substeps twice as long: by which share of the distance
  /// between their ends the better one is wrong.
  double share_of_distance() const { return 1 / (std::pow(2, order) - 1); }

 private:
  /// The share of the error allowed that is aimed at, and by how much the substep may change at once: at
  /// least doubled, or two substeps a step would never become one.
  static constexpr double safety = 0.7, slowest_change = 0.2, fastest_change = 2;
  static constexpr int most_attempts = 8;
  /// Of the first step, when nothing is known yet. The estimate sees if they are too few.
  static constexpr std::uint32_t first_substeps = 4;
};

}  // namespace plumb::detail
