// What visits of rigid rods and of rods that give have in common, in vectors of lanes. relax_lanes.hpp and
// law_lanes.hpp include it, and it has internal linkage as they have.

#pragma once

#include "simd/relax/access_lanes.hpp"

namespace plumb::simd {
namespace {

/// Writes twice the direction of every rod (m) and its violation |d|² − L² (m²), which sweeps read.
template <class Access, class T>
void prepare(const BlockView<T>& block, Range range) {
  for (std::size_t i = 0; i < (range.end - range.begin) * parts<T>; ++i) {
    const Position at = position<T>(range.begin, i);
    const Triple<T> d = Access::difference(block, block.x, at);
    const Batch<T> length2 =
        range.uniform ? Batch<T>(block.uniform_length2) : load_field<weight_fields>(block.weight, at, 0);
    T* rod = block.rod + std::size_t{at.v} * rod_fields * logical_width<T> + at.first;
    (d.x + d.x).store_aligned(rod);
    (d.y + d.y).store_aligned(rod + logical_width<T>);
    (d.z + d.z).store_aligned(rod + 2 * logical_width<T>);
    (dot(d, d) - length2).store_aligned(rod + 3 * logical_width<T>);
  }
}

/// Returns how far the vectors of rods have moved, and keeps their ends where there is room.
template <class Access, class T>
PLUMB_INLINE Triple<T> movement(const BlockView<T>& block, Position at,
                                typename Access::template Kept<T>& kept) {
  if constexpr (std::is_same_v<typename Access::template Kept<T>, Ends<T>>) {
    kept = Access::load_ends(block, at);
    return kept.b - kept.a;
  }
  return Access::difference(block, static_cast<const T*>(block.p), at);
}

/// Moves the ends, or adds to the sums that stand for them (Jacobi).
template <class Access, class T>
PLUMB_INLINE void move(const BlockView<T>& block, Position at, const typename Access::template Kept<T>& kept,
                       const Triple<T>& move_a, const Triple<T>& move_b) {
  if constexpr (std::is_same_v<typename Access::template Kept<T>, Ends<T>>) {
    if (block.out == block.p) return Access::store_ends(block, at, kept.a + move_a, kept.b - move_b);
  }
  Access::apply(block, at, move_a, move_b);
}

/// Returns the largest of the lanes, or 0; a lane that is not a number does not count.
template <class T>
PLUMB_INLINE T largest_lane(const Batch<T>& batch) {
  alignas(64) T lanes[width<T>];
  batch.store_aligned(lanes);
  T largest = 0;
  for (const T lane : lanes) largest = lane > largest ? lane : largest;
  return largest;
}

}  // namespace
}  // namespace plumb::simd
