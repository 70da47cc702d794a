#pragma once

#include <algorithm>
#include <chrono>
#include <cstdint>
#include <optional>

#include "plumb/report.hpp"
#include "time/substep_costs.hpp"

namespace plumb::detail {

/// Fits steps into a wall time, by what the last ones took. What it decides depends on the clock.
///
/// Equal substeps become fewer where that is cheaper (SubstepCosts), and those of what is late become one.
/// Under the control of an accuracy tries end early enough that the substeps which are asked for by number
/// fit as well.
class Budget {
 public:
  using Clock = std::chrono::steady_clock;
  using Time = std::optional<Clock::time_point>;

  /// Gives every step so much time (us) from now on, or as much as it takes.
  void set(std::optional<double> us) {
    *this = {};
    us_ = us;
    reserve_ = us.value_or(0) / 2;
  }
  std::size_t steps() const { return count_; }  ///< with a budget so far

  /// Begins a step. Returns how many of so many equal substeps fit. One of the first step takes `guess` (us).
  std::uint32_t begin_step(std::uint32_t asked, double guess) {
    if (!us_) return asked;
    begin_ = Clock::now();
    return costs_.fit(asked, safe_share * *us_, guess);
  }
  /// Returns when what is tried or cut in this step has to end, and what is left takes fewer substeps.
  Time deadline(bool is_controlled) const {
    if (!us_) return {};
    const double us = std::min(is_controlled ? *us_ - reserve_ : late_share * *us_, most_us);
    return begin_ + std::chrono::duration_cast<Clock::duration>(Micro(us));
  }
  /// Ends a step that took so many substeps, and reports what it took.
  void end_step(std::uint32_t taken, bool is_controlled, StepReport& report) {
    if (!us_) return;
    const double us = Micro(Clock::now() - begin_).count();
    report.step_us = us;
    report.asked_us = is_controlled ? us : us / costs_.relative(taken);
    if (is_controlled)
      reserve_ = std::min(
          *us_, std::max({least_reserve * *us_, 0.99 * reserve_, margin * (us - (*us_ - reserve_))}));
    else
      costs_.took(taken, us, report.capped_steps > 0);
    ++count_;
  }

 private:
  using Micro = std::chrono::duration<double, std::micro>;

  static constexpr double most_us = 1e12;  // The clock counts 2^63 ns.
  // They leave room for what a step takes beyond the last ones. bench/README.md has how many are late.
  static constexpr double safe_share = 0.7, late_share = 0.8, margin = 1.2, least_reserve = 0.05;

  std::optional<double> us_;
  Clock::time_point begin_;
  double reserve_ = 0;  ///< us at the end of a step in which nothing is tried any more
  SubstepCosts costs_;
  std::size_t count_ = 0;
};

}  // namespace plumb::detail
