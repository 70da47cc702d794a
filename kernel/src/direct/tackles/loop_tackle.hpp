#pragma once

#include <compare>
#include <cstddef>
#include <cstdint>
#include <vector>

namespace plumb::detail {

/// A tackle of an island runs through these vertices, one of which is movable at least. Between each two
/// there is a segment.
struct LoopTackle {
  std::vector<std::uint32_t> vertices;
  std::uint32_t first = 0;  ///< Number of its first segment among those of the island.

  std::uint32_t segments() const { return static_cast<std::uint32_t>(vertices.size()) - 1; }

  // Newton's matrix has these numbers of a tackle, one after the other. For every vertex: what -A^T has (3)
  // and what B has (3). For every segment: what couples both of its ends with themselves (9), and with each
  // other (9). Then soft.
  static constexpr std::uint32_t per_vertex = 6, per_segment = 18;
  std::uint32_t at_segments() const { return per_vertex * (segments() + 1); }
  std::uint32_t at_soft() const { return at_segments() + per_segment * segments(); }
  std::uint32_t values() const { return at_soft() + 1; }

  friend bool operator==(const LoopTackle&, const LoopTackle&) = default;
  friend auto operator<=>(const LoopTackle&, const LoopTackle&) = default;
};

}  // namespace plumb::detail
