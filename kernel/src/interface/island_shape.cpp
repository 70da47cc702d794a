#include "interface/island_shape.hpp"

#include <algorithm>

namespace plumb::detail {
namespace {

/// An island with loops is thin if its widest layer has no more particles than this. Rings, ladders and
/// trusses are thin, nets are not. A larger value factorises more islands, and solves fewer by lines.
constexpr std::size_t thin_layer = 12;

/// An island is vast if two measures of the work of a factorisation are more than these. One counts it layer
/// by layer: particles times the square of the widest layer. The other has the widest layer as the largest of
/// many that dissect it: its cube, and its product with the particles. Nets stay below up to 300 x 300
/// particles, and solids up to 20 x 20 x 20.
constexpr double vast_by_layers = 5e8, vast_dissected = 6e7;

/// Returns the number of particles in the widest layer. A layer holds the particles at one distance in rods
/// from an end of the island. It takes linear time.
std::size_t widest_layer(const layouts::Graph& island) {
  const layouts::Incidence incidence = layouts::edges_by_vertex(island);
  std::uint32_t start = 0;
  std::size_t widest = 0;
  for (int pass = 0; pass < 2; ++pass) {  // the second pass starts where the first ended, at one end
    Array<std::uint8_t> seen(island.vertices, 0);
    Array<std::uint32_t> layer{start}, next;
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

bool is_vast(const layouts::Graph& island) {
  const auto layer = static_cast<double>(widest_layer(island));
  return layer * layer * island.vertices > vast_by_layers &&
         layer * (layer * layer + island.vertices) > vast_dissected;
}

bool has_laws(const Scene& scene, std::span<const std::uint32_t> rods) {
  return std::any_of(rods.begin(), rods.end(),
                     [&](std::uint32_t rod) { return !scene.rods[rod].law.is_rigid(); });
}

bool all_elastic(const Scene& scene, std::span<const std::uint32_t> rods) {
  return std::all_of(rods.begin(), rods.end(),
                     [&](std::uint32_t rod) { return scene.rods[rod].law.is_elastic(); });
}

bool carries_mass(const Scene& scene, std::span<const std::uint32_t> rods, MassModel model) {
  return model == MassModel::consistent &&
         std::any_of(rods.begin(), rods.end(), [&](std::uint32_t rod) { return scene.rods[rod].mass > 0; });
}

}  // namespace plumb::detail
