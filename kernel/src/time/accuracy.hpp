#pragma once

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <span>

#include "interface/tally.hpp"
#include "math/elementary.hpp"

namespace plumb::detail {

/// Divides a step into windows of `length` substeps, an even number. Some windows are also taken by half as
/// many substeps, to compare.
struct Windows {
  std::uint32_t count, length;
  /// The first window is compared. That is needed where loads or anchors have changed, nothing has moved yet,
  /// or a fallback has left a velocity.
  bool starts_anew;

  /// Returns whether window k is compared: the last one is, and every other before it. No event between two
  /// of them is then missed by much.
  bool is_compared(std::uint32_t k) const {
    return (starts_anew && k == 0) || (count - 1 - k) % compared_one_of == 0;
  }
  std::uint32_t compared() const {
    const std::uint32_t regular = (count - 1) / compared_one_of + 1;
    return starts_anew && (count - 1) % compared_one_of != 0 ? regular + 1 : regular;
  }

  static constexpr std::uint32_t compared_one_of = 2;
};

/// Returns the distance (m) between two sets of positions with three numbers a node in every lane. It is the
/// root mean square over the nodes of the worst lane.
inline double largest_distance(std::span<const double> one, std::span<const double> other,
                               std::uint32_t nodes, std::size_t lanes) {
  double worst = 0;
  for (std::size_t lane = 0; lane < lanes; ++lane) {
    double sum = 0;
    for (std::size_t i = lane; i < one.size(); i += lanes) {
      const double apart = one[i] - other[i];
      sum += apart * apart;
    }
    worst = std::max(worst, sum);
  }
  return std::sqrt(worst / nodes);
}

/// Takes a step in as many substeps as keep the growth of the estimated error within `allowed`. Times are in
/// seconds.
struct AccuracyControl {
  double allowed;             ///< m/s that the estimated error of positions may grow by
  std::uint32_t least, most;  ///< bounds of the number of substeps in a step
  std::uint32_t order;        ///< order in time: errors fall with this power of the substep
  bool by_comparison;         ///< whether compare() estimates errors; otherwise the solver does

  struct Attempt {
    double error = 0;       ///< estimated error of one substep, m
    bool is_blind = false;  ///< substeps were cut, so that the two ways differ less than their errors
    bool is_final = false;  ///< more substeps would not solve it either
  };

  /// Prepares a step that stability would cut into `cuts` pieces.
  ///
  /// An anchor that changes its velocity strikes a blow, whose first acceleration grows as substeps shrink.
  /// Errors are therefore compared instead of estimated by the solver. Two ways that are cut into the same
  /// pieces agree without being accurate, so the least number of substeps is raised until neither is cut.
  void begin_step(bool anchors_changed, std::uint32_t cuts) {
    by_comparison = by_comparison || anchors_changed;
    if (by_comparison) least = std::max(least, 2 * cuts);
  }

  /// Takes a step of `dt`. `substep` holds the length that the last step found best, or 0.
  ///
  /// Calls `advance(h, substeps, counters)`, which returns an Attempt, and `restore()`, which takes it back.
  /// Of attempts taken back only the work counts. Returns false if the work was spent before an attempt
  /// ended; then all is taken back.
  template <class Advance, class Restore>
  bool step(double dt, double& substep, Tally& counters, Advance&& advance, Restore&& restore) const {
    if (substep == 0) substep = dt / first_substeps;
    double last_rate = std::numeric_limits<double>::infinity(), first = 0;
    for (int attempt = 1;; ++attempt) {
      const double wanted = std::ceil(dt / substep);
      auto substeps = static_cast<std::uint32_t>(
          std::clamp(wanted, double{1} * least, double{1} * std::max(most, least)));
      if (by_comparison) substeps += substeps % 2;
      const double h = dt / substeps;
      if (attempt == 1) first = h;
      Tally of_attempt = counters.begin_try();
      const Attempt result = advance(h, substeps, of_attempt);
      if (of_attempt.is_spent()) {
        restore();
        counters.take_back(of_attempt);
        ++counters.inaccurate_steps;
        substep = first;
        return false;
      }
      const double rate = std::max(result.error / (h * allowed), result.is_blind ? blind_rate : 0);
      // The error of a step of order p grows by an amount that is proportional to h^p in a second.
      const double change = root(safety / rate, order);
      substep = std::isnan(change) ? h : h * std::clamp(change, slowest_change, fastest_change);
      const bool accurate = rate <= 1 && !result.is_final;
      // Shorter steps make an estimate worse where it is rounding. They hardly improve it after a blow, which
      // no substep resolves. An attempt that had to be cut does not say how errors fall.
      const bool stalls = attempt > 2 && !std::isinf(last_rate) && !(rate < last_rate * least_gain);
      const bool hopeless = result.is_final || stalls;
      if (accurate || hopeless || attempt == most_attempts || substeps >= most) {
        counters.keep(of_attempt);
        if (accurate) return true;
        substep = hopeless ? first : h;
        ++counters.inaccurate_steps;
        return true;
      }
      last_rate = rate;
      restore();
      counters.take_back(of_attempt);
      ++counters.repeated_steps;
    }
  }

  /// Takes substeps of h, and some windows also by half as many of 2 h. The distance between the two ends
  /// tells the error of the better one (Richardson). The estimate is the mean over compared windows.
  ///
  /// `moved.advance(h, substeps, counters)` moves and `moved.keep()` marks the start of a window.
  /// `moved.take_back()` returns there and remembers where it came to. `moved.distance()` returns the
  /// distance (m) from that place.
  template <class Moved>
  Attempt compare(double h, std::uint32_t substeps, bool starts_anew, Moved&& moved, Tally& counters) const {
    Attempt out{.error = 0};
    double apart = 0;
    const Windows windows = windows_of(substeps, starts_anew);
    for (std::uint32_t k = 0; k < windows.count && !counters.is_spent(); ++k) {
      const bool is_compared = !out.is_final && windows.is_compared(k);
      if (is_compared) {
        moved.keep();
        Tally coarse = counters.begin_try();
        moved.advance(2 * h, windows.length / 2, coarse);
        if (coarse.has_given_up()) {  // shorter substeps would hardly do better, and cost as much again
          counters.keep(coarse);
          out.is_final = true;
          continue;
        }
        counters.take_back(coarse);
        out.is_blind = out.is_blind || coarse.halvings + coarse.fallbacks > 0;
        moved.take_back();
      }
      moved.advance(h, windows.length, counters);
      if (is_compared) apart += moved.distance();
      out.is_final = out.is_final || counters.has_given_up();
    }
    out.error = apart / (((1u << order) - 1.0) * windows.length * windows.compared());
    return out;
  }

 private:
  /// Errors of first order sit in velocities, and positions show them later. With gradient new the whole step
  /// is therefore one window.
  Windows windows_of(std::uint32_t substeps, bool starts_anew) const {
    return order == 1 ? Windows{1, substeps, starts_anew} : Windows{substeps / 2, 2, starts_anew};
  }

  /// The control aims at this share of the allowed error, and changes the substep by no more than these
  /// factors. It may double the substep at once, because otherwise two substeps a step would never become
  /// one.
  static constexpr double safety = 0.7, slowest_change = 0.2, fastest_change = 2;
  static constexpr int most_attempts = 8;
  /// A third or later attempt must leave at most this share of the error of the one before, or the control
  /// gives up.
  static constexpr double least_gain = 0.6;
  /// An error that could not be seen counts as this many times the allowed one, so that the next substep is
  /// about half as long.
  static constexpr double blind_rate = 4;
  /// The first step starts with this many substeps, when nothing is known yet. The estimate shows if they are
  /// too few.
  static constexpr std::uint32_t first_substeps = 4;
};

}  // namespace plumb::detail
