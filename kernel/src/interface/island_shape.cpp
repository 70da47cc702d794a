#include "interface/island_shape.hpp"

#include <algorithm>

namespace plumb::detail {
namespace {

/// Particles in the widest layer up to which an island with loops is thin: rings, ladders and trusses are,
/// nets are not. Measured by bench_direct, to an error of 1e-4: a truss of 100 bays is solved 20 to some
/// hundred times faster than relaxed, a ring of 24 about as fast; nets of 32 x 32 and 128 x 128 two and
/// seven times as fast, but at errors of a hundredth relaxation is cheaper there.
constexpr std::size_t thin_layer = 12;

/// Particles of the widest layer, counted in rods from one end. Linear time.
std::size_t widest_layer(const layouts::Graph& island) {
  const layouts::Incidence incidence = layouts::edges_by_vertex(island);
  std::uint32_t start = 0;
  std::size_t widest = 0;
  for (int pass = 0; pass < 2; ++pass) {  // the second starts where the first ended, at one end
    std::vector<std::uint8_t> seen(island.vertices, 0);
    std::vector<std::uint32_t> layer{start}, next;
    seen[start] = 1;
    widest = 0;
    while (!layer.empty()) {
      widest = std::max(widest, layer.size());
      start = layer.front();
      next.clear();
      for (const std::uint32_t v : layer)
        for (const std::uint32_t e : incidence.edges(v)) {
          const std::uint32_t other = layouts::other_end(island.edges[e], v);
          if (seen[other] != 0 || island.movable[other] == 0) continue;
          seen[other] = 1;
          next.push_back(other);
        }
      layer.swap(next);
    }
  }
  return widest;
}

}  // namespace

bool is_thin(const layouts::Graph& island) {
  return widest_layer(island) <= thin_layer;
}

bool carries_mass(const Scene& scene, std::span<const std::uint32_t> rods, MassModel model) {
  return model == MassModel::consistent &&
         std::any_of(rods.begin(), rods.end(), [&](std::uint32_t rod) { return scene.rods[rod].mass > 0; });
}

}  // namespace plumb::detail
