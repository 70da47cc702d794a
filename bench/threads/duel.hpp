#pragma once

#include <cstdint>
#include <vector>

#include "contest/case.hpp"

namespace plumb::bench {

/// Compares one thread with two over the same scene.
struct Duel {
  Case c{};
  std::uint32_t rods = 0;
  std::uint32_t sweeps = 0;
  bool is_paused =
      false;  ///< steps come one by one after a pause, as frames do, and helpers have gone to sleep
  bool is_parallel = false;     ///< if false, plumb gave the second thread nothing to do
  std::vector<double> one_s{};  ///< seconds per step, one sample per round
  std::vector<double> two_s{};

  /// Returns the median over rounds of two threads' time over one's. Below 1 two threads win.
  double ratio() const;
  /// Returns the ratio of the least times.
  double ratio_of_least() const;
  double projections() const { return double{1} * rods * sweeps; }
};

/// Holds two duels: step after step, and with pauses of `pause_s` (s) between steps. Rounds alternate in who
/// begins. With `any_size` two threads share work that plumb itself would leave to one. Throws CheckFailed if
/// the two worlds end in different bits.
std::vector<Duel> hold_duels(const Case& c, std::uint32_t sweeps, std::uint32_t rounds, double pause_s,
                             bool any_size);

}  // namespace plumb::bench
