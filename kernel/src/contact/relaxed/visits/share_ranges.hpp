#pragma once

#include <algorithm>
#include <array>
#include <cstdint>
#include <span>

#include "simd/relax/relax_kernels.hpp"
#include "threads/team.hpp"

namespace plumb::detail {

/// Calls f(ranges, part) for all ranges, one after the other. A team shares those that are large.
template <class F>
void share_ranges(Team* team, std::span<const simd::ContactRange> ranges, F&& f) {
  constexpr std::uint32_t least = 32;  // vectors that take longer than threads to meet
  if (team == nullptr || team->parts() == 1) return f(ranges, 0u);
  for (const simd::ContactRange& range : ranges) {
    const std::uint32_t vectors = range.end - range.begin;
    if (vectors < least) {
      f(std::span(&range, 1), 0u);
      continue;
    }
    team->for_parts([&](unsigned part) {
      const simd::ContactRange own{range.begin + Team::begin_of(vectors, part, team->parts()),
                                   range.begin + Team::begin_of(vectors, part + 1, team->parts()),
                                   range.terms};
      f(std::span(&own, 1), part);
    });
  }
}

/// Visits the contacts of all ranges once.
template <class Kernels, class View>
void sweep_ranges(Team* team, std::span<const simd::ContactRange> ranges, const Kernels& kernels,
                  const View& view) {
  share_ranges(team, ranges, [&](std::span<const simd::ContactRange> own, unsigned) {
    kernels.sweep(view, own.data(), static_cast<std::uint32_t>(own.size()));
  });
}

/// Does so, and returns the largest of what the kernels measure.
template <class Kernels, class View>
double measure_ranges(Team* team, std::span<const simd::ContactRange> ranges, const Kernels& kernels,
                      const View& view) {
  std::array<double, Team::max_size> largest{};
  share_ranges(team, ranges, [&](std::span<const simd::ContactRange> own, unsigned part) {
    const double found = kernels.measure(view, own.data(), static_cast<std::uint32_t>(own.size()));
    largest[part] = std::max(largest[part], found);
  });
  return *std::max_element(largest.begin(), largest.end());
}

}  // namespace plumb::detail
