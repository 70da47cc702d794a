#pragma once

#include <cstdint>
#include <span>

#include "plumb/layouts/memory.hpp"
#include "plumb/scene.hpp"
#include "scene/bends/rod_table.hpp"

namespace plumb::detail {

/// Refuses reels as validate() says, in a scene whose particles and rods pass it.
void validate_reels(const Scene& scene);

/// Returns the rods of a reel's chain, from the drum on.
Array<std::uint32_t> rods_of(const RodTable& rods, const Reel& reel);
/// Returns the length of a reel's chain, in m.
double chain_length(const Scene& scene, const RodTable& rods, const Reel& reel);
/// Says whether more (m) would be out than a chain of `whole` (m) has, but for rounding of their sums.
inline bool exceeds_chain(double out, double whole) {
  return out > (1 + 1e-12) * whole;
}

/// This is how a reel starts.
struct ReelStart {
  Array<double> behind;  ///< Lengths of the chain beyond its particles, in m.
  double out;            ///< It is in m.
  std::uint32_t first;   ///< The first particle of the chain that is free.

  double leaving() const { return out - behind[first]; }  ///< Length of the rod that leaves the drum, in m.
};
ReelStart start_of(const Scene& scene, const RodTable& rods, const Reel& reel);

/// Says by rod whether it belongs to a reel; empty if there are no reels.
Array<std::uint8_t> reeled_rods(const Scene& scene);
/// Says by rod whether it is wound or leaves a drum at `positions` (m), so that nobody knows how long it
/// should be; empty if there are no reels.
Array<std::uint8_t> rods_at_drums(const Scene& scene, std::span<const Vec3> positions);

}  // namespace plumb::detail
