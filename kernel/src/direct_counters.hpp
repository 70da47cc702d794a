#pragma once

#include <atomic>
#include <cstdint>

namespace plumb::detail {

/// Counts of a step, added to from several threads; substeps and iterations per tree or island with loops.
struct DirectCounters {
  std::atomic<std::uint64_t> substeps{0}, newton{0}, halvings{0}, fallbacks{0}, unsolved{0}, repeated{0},
      inaccurate{0};
};

}  // namespace plumb::detail
