#pragma once

#include <cstdint>
#include <span>

#include "plumb/layouts/islands.hpp"
#include "plumb/layouts/memory.hpp"
#include "plumb/scene.hpp"

namespace plumb::detail {

/// Finds the islands of a scene with the graph `graph` of particles and rods. A bend, a tackle or a twist
/// joins its particles into one island, also through a fixed one. Without them they are those of
/// layouts::find_islands().
layouts::Islands find_bent_islands(const Scene& scene, const layouts::Graph& graph);

/// Lists the bends, tackles, twists and reels of every island of a scene.
class IslandElements {
 public:
  IslandElements() = default;  ///< There are none.
  IslandElements(const Scene& scene, const layouts::Islands& islands);

  /// These return the numbers of those of an island.
  std::span<const std::uint32_t> bends_of(std::uint32_t island) const { return of(bends_, island); }
  std::span<const std::uint32_t> tackles_of(std::uint32_t island) const { return of(tackles_, island); }
  std::span<const std::uint32_t> twists_of(std::uint32_t island) const { return of(twists_, island); }
  std::span<const std::uint32_t> reels_of(std::uint32_t island) const { return of(reels_, island); }
  bool any_of(std::uint32_t island) const {
    return !bends_of(island).empty() || !tackles_of(island).empty() || !twists_of(island).empty() ||
           !reels_of(island).empty();
  }

 private:
  using Lists = Array<Array<std::uint32_t>>;  ///< by island; empty if the scene has none
  static std::span<const std::uint32_t> of(const Lists& lists, std::uint32_t island) {
    if (lists.empty()) return {};
    return lists[island];
  }

  Lists bends_, tackles_, twists_, reels_;
};

}  // namespace plumb::detail
