// What finds where lines touch each other, for line_scalar.hpp and line_lanes.hpp.

#pragma once

#include <cstdint>

namespace plumb::simd {

/// Numbers of a line, the middle of a capsule, as four records.
namespace line_fields {
inline constexpr std::uint32_t p = 0, q = 4;         ///< m, where its ends are
inline constexpr std::uint32_t radius = 3;           ///< m
inline constexpr std::uint32_t moves = 7;            ///< m, how far one of its ends goes at most
inline constexpr std::uint32_t p_by = 8, q_by = 12;  ///< m, how far they go
inline constexpr std::uint32_t count = 16;
}  // namespace line_fields

struct LinePair {
  std::uint32_t one, other;
};

/// Says what counts as a touch.
struct LineRules {
  double margin = 0;  ///< m, what comes nearer touches
  double passes = 0;  ///< what moves by more than the margin and this share of its radii is fast
};

/// Says where two lines come so near in a substep that they touch.
struct LineTouch {
  double gap, x, y, z;        ///< m; the unit vector from the second line to the first
  double a, b;                ///< places along them, from 0 to 1
  double closing;             ///< m, how the gap changes
  std::uint32_t pair, which;  ///< of the pairs; of its places, or `fast`

  /// Stands for a pair that may pass, whose places are not found here.
  static constexpr std::uint32_t fast = 3;
};

/// At most so many places of a pair touch: where the lines are nearest, and the ends of the part that lines
/// along each other have in common.
inline constexpr std::uint32_t most_line_touches = 3;
/// At most so many pairs are looked at at once.
inline constexpr std::uint32_t most_line_pairs = 64;

struct LineKernels {
  /// Finds touches of pairs among lines, in the order of pairs and of their places. Returns how many.
  std::uint32_t (*find)(const double* lines, const LinePair* pairs, std::uint32_t count, const LineRules&,
                        LineTouch* out);
};

}  // namespace plumb::simd
