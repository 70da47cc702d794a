#pragma once

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

}  // namespace plumb::detail
