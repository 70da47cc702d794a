#pragma once

#include <algorithm>
#include <cstdint>

namespace plumb::detail {

/// Which positions a sweep visits within (stages inside a position) and across (to the next position).
struct SweepBounds {
  std::int64_t within_begin, within_end, across_begin, across_end;
};

/// Pipelines sweeps over a line of positions so that each is worked on by many sweeps while it is in cache, with the
/// result of one sweep after the other. Sweep s + 1 may visit position q once sweep s has joined q to both its
/// neighbours, so it runs one position behind.
///
/// `bounds(s)` gives what sweep s visits; `within(q)` and `across(q)` do the work.
template <class Bounds, class Within, class Across>
void run_wavefront(std::int64_t sweeps, const Bounds& bounds, const Within& within, const Across& across) {
  std::int64_t begin = bounds(0).within_begin, end = 0;
  for (std::int64_t s = 0; s < sweeps; ++s) {
    const SweepBounds b = bounds(s);
    begin = std::min({begin, b.within_begin + s, b.across_begin + s + 1});
    end = std::max({end, b.within_end + s, b.across_end + s + 1});
  }
  for (std::int64_t t = begin; t < end; ++t)
    for (std::int64_t s = 0; s < sweeps; ++s) {
      const SweepBounds b = bounds(s);
      const std::int64_t q = t - s;
      if (q >= b.within_begin && q < b.within_end) within(q);
      if (q - 1 >= b.across_begin && q - 1 < b.across_end) across(q - 1);
    }
}

/// What one thread may do with positions [cut_begin, cut_end) alone: at each inner cut every sweep visits one position
/// less, so that nothing is read that another thread changes.
struct Trapezoid {
  std::int64_t cut_begin, cut_end;
  bool first, last;

  SweepBounds operator()(std::int64_t s) const {
    const std::int64_t left = first ? cut_begin : cut_begin + s;
    return {left, last ? cut_end : cut_end - s, left, last ? cut_end : cut_end - 1 - s};
  }
};

/// What is left to do around an inner cut once the threads on both sides are through.
struct CutTriangle {
  std::int64_t cut;

  SweepBounds operator()(std::int64_t s) const { return {cut - s, cut + s, cut - 1 - s, cut + s}; }
};

/// Longest run of sweeps whose trapezoids leave every thread some work.
inline std::int64_t sweeps_between_barriers(std::int64_t positions, std::int64_t threads) {
  return (positions / threads - 2) / 2;
}

}  // namespace plumb::detail
