#pragma once

#include <compare>
#include <cstdint>

#include "direct/laws/loop_laws.hpp"
#include "plumb/layouts/memory.hpp"
#include "plumb/vec3.hpp"

namespace plumb::detail {

/// The drum of a reel is the first of these vertices, and rod j of the chain joins the vertices j and j + 1.
struct LoopReel {
  Array<std::uint32_t> vertices, rods;

  friend bool operator==(const LoopReel&, const LoopReel&) = default;
  friend auto operator<=>(const LoopReel&, const LoopReel&) = default;
};

/// These numbers of a chain never change. They are by vertex, or by rod.
struct LoopReelNumbers {
  Array<double> mass;    ///< Masses of vertices, in units of the island's.
  Array<double> behind;  ///< Lengths of the chain beyond vertices, in m.
  Array<double> length;  ///< Nominal lengths of rods, in m.
  Array<LoopLaws::Numbers> laws;
};

/// Steps change these numbers of a reel.
///
/// The rod that leaves the drum is shorter than what is out of it by a corner that a particle cut when it
/// came in. That goes from `corner` (m), at the slope `corner_slope`, to 0 while the drum turns by `span`
/// (m), and it has turned by `turned` (m) since.
struct LoopReelMotion {
  double out, rate = 0;     ///< Length that is out, in m, and its rate, in m/s.
  std::uint32_t first = 1;  ///< The first particle of the chain that is free.
  double corner = 0, corner_slope = 0, span = 0, turned = 0;
  Vec3 aside{};     ///< Where the line of a carried particle ends, from the first free one, in m.
  Vec3 momentum{};  ///< That of wound and carried particles, in kg m/s.
};

/// A substep makes this of a reel. The carried particle pulls its free neighbour by `push` - `added` times
/// its displacement.
struct ReelSubstep {
  Vec3 push;
  double added;
  Vec3 before;  ///< Velocity of that neighbour before a blow, in m/s.
};

template <class Archive>
void visit_members(Archive& archive, LoopReelMotion& of) {
  auto& [out, rate, first, corner, corner_slope, span, turned, aside, momentum] = of;
  archive(out, rate, first, corner, corner_slope, span, turned, aside, momentum);
}

}  // namespace plumb::detail
