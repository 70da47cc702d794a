#pragma once

#include <algorithm>
#include <array>
#include <cstdint>
#include <limits>

namespace plumb::detail {

/// Says which positions a sweep visits, for stages inside a position and for stages across to the next one.
struct SweepBounds {
  std::int64_t within_begin, within_end, across_begin, across_end;
};

/// At most this many sweeps are in flight in a wavefront. Each further one keeps two more positions in cache.
inline constexpr std::int64_t sweeps_in_flight = 8;

/// Pipelines sweeps over a line of positions, so that many sweeps work on each position while it is in cache.
/// The result is that of one sweep after the other.
///
/// Sweep s + 1 may visit position q once sweep s has joined q to both its neighbours. It follows two
/// positions behind, not one. A vector shifted by a lane is stored across two of the vectors that are loaded
/// next. A processor loads those only once the store has left for the cache.
///
/// `bounds(s)` gives what sweep s visits, for at most sweeps_in_flight sweeps. `within(q)` and `across(q)` do
/// the work.
template <class Bounds, class Within, class Across>
void run_wavefront(std::int64_t sweeps, const Bounds& bounds, const Within& within, const Across& across) {
  std::array<SweepBounds, sweeps_in_flight> at{};  // counted in steps of the wavefront instead of positions
  std::int64_t begin = std::numeric_limits<std::int64_t>::max(),
               end = std::numeric_limits<std::int64_t>::min();
  for (std::int64_t s = 0; s < sweeps; ++s) {
    const SweepBounds b = bounds(s);
    at[s] = {b.within_begin + 2 * s, b.within_end + 2 * s, b.across_begin + 2 * s + 1,
             b.across_end + 2 * s + 1};
    begin = std::min({begin, at[s].within_begin, at[s].across_begin});
    end = std::max({end, at[s].within_end, at[s].across_end});
  }
  for (std::int64_t t = begin; t < end; ++t) {
    for (std::int64_t s = 0; s < sweeps; ++s)
      if (t >= at[s].within_begin && t < at[s].within_end) within(t - 2 * s);
    for (std::int64_t s = 0; s < sweeps; ++s)
      if (t >= at[s].across_begin && t < at[s].across_end) across(t - 2 * s - 1);
  }
}

/// Says what one thread may do alone with positions [cut_begin, cut_end). At each inner cut every sweep
/// visits one position less, so that nothing is read that another thread changes.
struct Trapezoid {
  std::int64_t cut_begin, cut_end;
  bool first, last;

  SweepBounds operator()(std::int64_t s) const {
    const std::int64_t left = first ? cut_begin : cut_begin + s;
    return {left, last ? cut_end : cut_end - s, left, last ? cut_end : cut_end - 1 - s};
  }
};

/// Says what is left to do around an inner cut once the threads on both sides are through.
struct CutTriangle {
  std::int64_t cut;

  SweepBounds operator()(std::int64_t s) const { return {cut - s, cut + s, cut - 1 - s, cut + s}; }
};

/// Returns the longest run of sweeps whose trapezoids leave every thread some work.
inline std::int64_t sweeps_between_barriers(std::int64_t positions, std::int64_t threads) {
  return (positions / threads - 2) / 2;
}

}  // namespace plumb::detail
