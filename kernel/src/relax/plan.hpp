#pragma once

#include <cstdint>
#include <span>

#include "interface/island_sets.hpp"
#include "plumb/layouts/memory.hpp"
#include "plumb/layouts/packing.hpp"
#include "plumb/settings.hpp"
#include "relax/constants.hpp"

namespace plumb::detail {

/// A chain shorter than this stays in the second cache and on one thread, so that nothing is gained by
/// pipelining its sweeps. Segments, whose rows are aligned, are then 8 % faster than streams.
inline constexpr std::uint32_t longest_segments = 8192;

/// Returns 1 for each rod of the commonest kind with equal masses at both ends.
Array<std::uint8_t> common_rods(const Scene& scene, const Constants& constants);

/// Refuses what cannot be addressed with 32 bits: the particles and rods of a scene, or of a block with those
/// that its layout repeats or adds as padding. Throws InputError.
void require_addressable(std::uint64_t particles, std::uint64_t rods);

/// Packs islands of particles and rods into blocks and picks each block's layout by its shape:
///   equal small islands   lanes, array of structures of arrays
///   chain                 even and odd streams, structure of arrays
///   grid                  strips of rows in lanes, array of structures of arrays
///   anything else         records, array of structures
/// A `layout` other than automatic asks every shape for that layout. `common[rod]` marks rods that weigh the
/// same. Throws InputError if a block would be too large (see require_addressable()).
Array<layouts::Packing> plan_blocks(const IslandSets& sets, LayoutChoice layout,
                                    std::span<const std::uint8_t> common, std::uint32_t lanes,
                                    std::uint32_t element_bytes);

}  // namespace plumb::detail
