#pragma once

#include <atomic>
#include <cstdint>

namespace plumb::detail {

/// Counts of a step, added to from several threads; substeps and iterations per tree or island with loops.
struct DirectCounters {
  std::atomic<std::uint64_t> substeps{0}, newton{0}, halvings{0}, fallbacks{0}, unsolved{0}, repeated{0},
      inaccurate{0};

  void add(const DirectCounters& other) {
    const auto add = [](std::atomic<std::uint64_t>& to, const std::atomic<std::uint64_t>& from) {
      to.fetch_add(from.load(std::memory_order_relaxed), std::memory_order_relaxed);
    };
    add(substeps, other.substeps);
    add(newton, other.newton);
    add(halvings, other.halvings);
    add(fallbacks, other.fallbacks);
    add(unsolved, other.unsolved);
    add(repeated, other.repeated);
    add(inaccurate, other.inaccurate);
  }
};

}  // namespace plumb::detail
