#pragma once

#include <cstdint>

namespace plumb::detail {

/// What was done in a step; substeps and iterations per tree or island with loops. Each thread counts its
/// own, in a cache line of its own.
struct alignas(64) DirectCounters {
  std::uint64_t substeps = 0, newton = 0, halvings = 0, fallbacks = 0, unsolved = 0, repeated = 0,
                inaccurate = 0;

  void add(const DirectCounters& other) {
    substeps += other.substeps;
    newton += other.newton;
    halvings += other.halvings;
    fallbacks += other.fallbacks;
    unsolved += other.unsolved;
    repeated += other.repeated;
    inaccurate += other.inaccurate;
  }
};

}  // namespace plumb::detail
