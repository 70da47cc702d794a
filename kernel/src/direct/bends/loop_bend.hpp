#pragma once

#include <array>
#include <cstdint>

namespace plumb::detail {

/// A bend of an island has three vertices, the second between the others. One at least is movable.
struct LoopBend {
  std::array<std::uint32_t, 3> vertices;

  /// A pair of its particles, by their places in `vertices`.
  struct Pair {
    std::uint32_t i, j;
  };
  static constexpr std::array<Pair, 6> pairs{{{0, 0}, {1, 1}, {2, 2}, {0, 1}, {0, 2}, {1, 2}}};
  static constexpr std::uint32_t values = 9 * pairs.size();  ///< Newton's matrix has so many of each.

  friend constexpr bool operator==(const LoopBend&, const LoopBend&) = default;
  friend constexpr auto operator<=>(const LoopBend&, const LoopBend&) = default;
};

}  // namespace plumb::detail
