#pragma once

#include <compare>
#include <cstddef>
#include <cstdint>

#include "plumb/layouts/memory.hpp"

namespace plumb::detail {

/// A tackle of an island runs through these vertices, one of which is movable at least. Between each two
/// there is a segment.
///
/// With friction every segment has a multiplier, that of the first being the tackle's own. The others belong
/// to pulleys: pulley p is vertex p + 1, and behind it lies segment p + 1.
struct LoopTackle {
  Array<std::uint32_t> vertices;
  std::uint32_t first = 0;         ///< Number of its first segment among those of the island.
  bool rubs = false;               ///< There is friction.
  std::uint32_t first_pulley = 0;  ///< Number of its first pulley with friction among those of the island.

  std::uint32_t segments() const { return static_cast<std::uint32_t>(vertices.size()) - 1; }
  std::uint32_t pulleys() const { return rubs ? segments() - 1 : 0; }

  // Newton's matrix has these numbers of a tackle, one after the other. For every vertex: what -A^T has (3)
  // and what B has (3). For every segment: what couples both of its ends with themselves (9), and with each
  // other (9). Then soft. With friction -A^T is that of the first segment alone, and pulleys follow.
  static constexpr std::uint32_t per_vertex = 6, per_segment = 18;
  std::uint32_t at_segments() const { return per_vertex * (segments() + 1); }
  std::uint32_t at_soft() const { return at_segments() + per_segment * segments(); }
  std::uint32_t values() const { return at_pulley(pulleys()); }

  // For every pulley: what -A^T has at both ends of the segment behind (6), then what its row has at its own
  // and all later vertices (3 each), at its own multiplier and at that of the segment before.
  static constexpr std::uint32_t in_pulley = 6;
  std::uint32_t at_pulley(std::uint32_t p) const {
    return at_soft() + 1 + p * (in_pulley + 2) + 3 * (p * segments() - p * (p > 0 ? p - 1 : 0) / 2);
  }
  std::uint32_t in_own(std::uint32_t p) const { return in_pulley + 3 * (segments() - p); }

  friend bool operator==(const LoopTackle&, const LoopTackle&) = default;
  friend auto operator<=>(const LoopTackle&, const LoopTackle&) = default;
};

}  // namespace plumb::detail
