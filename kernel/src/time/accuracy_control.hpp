#pragma once

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <span>

#include "math/elementary.hpp"
#include "step/direct_counters.hpp"

namespace plumb::detail {

/// The substeps of a step, some of which are also taken with half as many. Length: substeps, even.
struct Stretches {
  std::uint32_t count, length;
  /// Loads or anchors have changed, or nothing has moved yet, or a fallback has left a velocity: the first is
  /// compared.
  bool starts_anew;

  /// The last, and every other before: an event between two must not be missed by much.
  bool is_compared(std::uint32_t k) const {
    return (starts_anew && k == 0) || (count - 1 - k) % compared_one_of == 0;
  }
  std::uint32_t compared() const {
    const std::uint32_t regular = (count - 1) / compared_one_of + 1;
    return starts_anew && (count - 1) % compared_one_of != 0 ? regular + 1 : regular;
  }

  static constexpr std::uint32_t compared_one_of = 2;
};

/// How far apart two sets of positions are, 3 numbers a node in every lane: RMS over the nodes of the worst
/// lane, m.
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

/// Steps in as many substeps as keep the estimated error's growth within `allowed`. Times in s.
struct AccuracyControl {
  double allowed;             ///< m/s
  std::uint32_t least, most;  ///< substeps of a step
  std::uint32_t order;        ///< in time
  bool by_comparison;         ///< estimates are of compare(), not of the stepper

  struct Attempt {
    double error = 0;       ///< estimated, of a substep, m
    bool is_blind = false;  ///< substeps were cut: what was compared is more alike than it should be
    bool is_final = false;  ///< it cannot be solved, however many substeps there are
  };

  /// For a step before which anchors have changed their velocity or not, and which stability would cut into
  /// so many pieces. The first acceleration after such a change is a blow, the greater the shorter it is, so
  /// it is compared. What is cut into the same pieces one way and the other is alike, not accurate: there are
  /// enough substeps that those of compare() that are twice as long need not be cut.
  void begin_step(bool anchors_changed, std::uint32_t pieces) {
    by_comparison = by_comparison || anchors_changed;
    if (by_comparison) least = std::max(least, 2 * pieces);
  }

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
      if (by_comparison) substeps += substeps % 2;
      const double h = dt / substeps;
      if (attempt == 1) first = h;
      DirectCounters of_attempt;
      const Attempt result = advance(h, substeps, of_attempt);
      const double rate = std::max(result.error / (h * allowed), result.is_blind ? blind_rate : 0);
      // The error of a step of order p grows by h^p a second.
      const double change = root(safety / rate, order);
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
        ++counters.inaccurate;
        return;
      }
      last_rate = rate;
      restore();
      counters.newton += of_attempt.newton;
      ++counters.repeated;
    }
  }

  /// Takes a step's substeps of h, some stretches of them also by half as many of 2 h. How far apart the two
  /// end says how wrong the better is (Richardson): the estimate is the mean over the stretches compared.
  /// `advance(h, substeps, counters)` moves, `keep()` marks where a stretch starts, `take_back()` goes back
  /// there but remembers where it came to, and `distance()` is how far from that it is now, m.
  template <class Advance, class Keep, class TakeBack, class Distance>
  Attempt compare(double h, std::uint32_t substeps, bool starts_anew, DirectCounters& counters,
                  Advance&& advance, Keep&& keep, TakeBack&& take_back, Distance&& distance) const {
    Attempt out{.error = 0};
    double apart = 0;
    const Stretches stretches = stretches_of(substeps, starts_anew);
    for (std::uint32_t k = 0; k < stretches.count; ++k) {
      const bool is_compared = !out.is_final && stretches.is_compared(k);
      if (is_compared) {
        keep();
        DirectCounters coarse;
        advance(2 * h, stretches.length / 2, coarse);
        if (coarse.unsolved > 0) {  // shorter ones would hardly be better, and cost as much again
          counters.add(coarse);
          out.is_final = true;
          continue;
        }
        counters.newton += coarse.newton;  // of what is thrown away only the work counts
        out.is_blind = out.is_blind || coarse.halvings + coarse.fallbacks > 0;
        take_back();
      }
      advance(h, stretches.length, counters);
      if (is_compared) apart += distance();
      out.is_final = out.is_final || counters.unsolved > 0;
    }
    out.error = apart / (((1u << order) - 1.0) * stretches.length * stretches.compared());
    out.is_blind = out.is_blind || counters.fallbacks > 0;
    return out;
  }

 private:
  /// Errors of first order are of velocities, and positions show them later: the whole step is one stretch.
  Stretches stretches_of(std::uint32_t substeps, bool starts_anew) const {
    return order == 1 ? Stretches{1, substeps, starts_anew} : Stretches{substeps / 2, 2, starts_anew};
  }

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
