#pragma once

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>

#include "direct_counters.hpp"

namespace plumb::detail {

/// Steps in as many substeps as keep the estimated error's growth within `allowed`. Times in s.
struct AccuracyControl {
  double allowed;             ///< m/s
  std::uint32_t least, most;  ///< substeps of a step
  std::uint32_t order;        ///< in time
  bool by_two_runs;           ///< estimates are of a run with half as many substeps, too: they are even

  struct Attempt {
    double error;           ///< estimated, of a substep, m
    bool is_blind = false;  ///< substeps were cut: what was compared is more alike than it should be
    bool is_final = false;  ///< it cannot be solved, however many substeps there are
  };

  /// `substep` is what the last step thought best; 0 if there was none. `advance(h, substeps, counters)`
  /// returns an Attempt; `restore()` takes back what it did, of which only the work counts.
  template <class Advance, class Restore>
  void step(double dt, double& substep, DirectCounters& counters, Advance&& advance,
            Restore&& restore) const {
    if (substep == 0) substep = dt / first_substeps;
    double last_rate = std::numeric_limits<double>::infinity(), first = 0;
    for (int attempt = 1;; ++attempt) {
      const double wanted = std::ceil(dt / substep);
      auto substeps = static_cast<std::uint32_t>(
          std::clamp(wanted, double{1} * least, double{1} * std::max(most, least)));
      if (by_two_runs) substeps += substeps % 2;
      const double h = dt / substeps;
      if (attempt == 1) first = h;
      DirectCounters of_attempt;
      const Attempt result = advance(h, substeps, of_attempt);
      const double rate = std::max(result.error / (h * allowed), result.is_blind ? blind_rate : 0);
      // The error of a step of order p grows by h^p a second.
      const double change = std::pow(safety / rate, 1.0 / order);
      substep = std::isnan(change) ? h : h * std::clamp(change, slowest_change, fastest_change);
      const bool accurate = rate <= 1 && !result.is_final;
      // Where rounding is what is estimated, shorter steps make it worse; after a blow, which no substep
      // resolves, hardly better. One that had to be cut says nothing of how errors fall.
      const bool stalls = attempt > 2 && !std::isinf(last_rate) && !(rate < last_rate * least_gain);
      const bool hopeless = result.is_final || stalls;
      if (accurate || hopeless || attempt == most_attempts || substeps >= most) {
        counters.add(of_attempt);
        if (accurate) return;
        substep = hopeless ? first : h;
        counters.inaccurate.fetch_add(1, std::memory_order_relaxed);
        return;
      }
      last_rate = rate;
      restore();
      counters.newton.fetch_add(of_attempt.newton, std::memory_order_relaxed);
      counters.repeated.fetch_add(1, std::memory_order_relaxed);
    }
  }

  /// Of a run, from how far it ends from one with substeps twice as long (Richardson), m a substep.
  double error_of_substep(double distance, std::uint32_t substeps) const {
    return distance / ((std::pow(2, order) - 1) * substeps);
  }

 private:
  /// The share of the error allowed that is aimed at, and by how much the substep may change at once: at
  /// least doubled, or two substeps a step would never become one.
  static constexpr double safety = 0.7, slowest_change = 0.2, fastest_change = 2;
  static constexpr int most_attempts = 8;
  /// What a third and later attempt must leave at most of the one before.
  static constexpr double least_gain = 0.6;
  /// Of the error allowed, what is taken for one that could not be seen: next time half as long, about.
  static constexpr double blind_rate = 4;
  /// Of the first step, when nothing is known yet. The estimate sees if they are too few.
  static constexpr std::uint32_t first_substeps = 4;
};

}  // namespace plumb::detail
