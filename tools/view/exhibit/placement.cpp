#include "view/exhibit/placement.hpp"

#include <span>

#include "plumb/layouts/aligned_buffer.hpp"
#include "plumb/layouts/coloring.hpp"
#include "plumb/layouts/islands.hpp"
#include "plumb/layouts/ordering.hpp"
#include "plumb/layouts/packing.hpp"
#include "plumb/layouts/shapes.hpp"

namespace plumb::view {
namespace {

using namespace layouts;

constexpr std::uint32_t lanes = lane_width<float>;
/// Longer chains are not put side by side, as in the kernel's plan of blocks.
constexpr std::size_t longest_lane_island = 1024;
/// Longer chains are streams rather than segments.
constexpr std::size_t longest_segments = 8192;

class Placer {
 public:
  explicit Placer(const Scene& scene)
      : none_common_(scene.rods.size(), 0),
        out_{std::vector(scene.rods.size(), no_place), std::vector(scene.rods.size(), no_place)} {
    std::vector<std::uint8_t> movable;
    for (const Rod& rod : scene.rods) edges_.push_back({rod.a, rod.b});
    for (const Particle& particle : scene.particles) movable.push_back(particle.fixed ? 0 : 1);
    const Graph graph{static_cast<std::uint32_t>(movable.size()), edges_, movable};
    islands_ = find_islands(graph);
    for (const auto& equal : group_equal_islands(graph, islands_))
      place(equal, local_graph(graph, islands_, equal.front()));
  }

  Placement placed() && { return std::move(out_); }

 private:
  Piece piece(std::uint32_t island) const {
    return {island, islands_.vertices(island), islands_.edges(island)};
  }

  void place(std::span<const std::uint32_t> equal, const LocalGraph& local) {
    if (local.edges.empty()) return;
    const ShapeInfo shape = detect_shape(local.view());
    const Coloring coloring = color_by_shape(local.view(), shape);
    std::vector<Piece> pieces;
    for (const std::uint32_t island : equal) {
      pieces.push_back(piece(island));
      for (std::size_t i = 0; i < coloring.color_of_edge.size(); ++i)
        out_.color_of_rod[pieces.back().edges[i]] = coloring.color_of_edge[i];
    }
    const bool is_short = shape.shape == Shape::graph || local.edges.size() < longest_lane_island;
    if (equal.size() > 1 && equal.size() * 4 >= lanes && is_short) {
      const std::vector<std::uint8_t> common(local.edges.size(), 0);
      take(pack_lanes(pieces, local.view(), coloring, common, lanes));
      return;
    }
    for (const Piece& each : pieces) take(pack(each, local, shape, coloring));
  }

  Packing pack(const Piece& piece, const LocalGraph& local, const ShapeInfo& shape,
               const Coloring& coloring) const {
    if (shape.shape == Shape::chain)
      return local.edges.size() < longest_segments ? pack_segments(piece, shape, lanes)
                                                   : pack_streams(piece, shape, lanes, sizeof(float));
    const std::uint32_t rows = ((shape.height + lanes - 1) / lanes + 1) / 2 * 2;
    if (shape.shape == Shape::grid && 2 * shape.height >= rows * lanes)
      return pack_strips(piece, shape, lanes);
    IndexedPiece indexed{piece, local.view(), coloring, shape.vertex_order};
    if (shape.shape == Shape::graph) indexed.vertex_order = bandwidth_reducing_order(local.view());
    return pack_indexed(std::span(&indexed, 1), Layout::aos, none_common_, lanes, sizeof(float), "graph");
  }

  void take(const Packing& packing) {
    for (std::size_t i = 0; i < packing.lane_edge.size(); ++i)
      if (packing.lane_edge[i] != layouts::none)
        out_.lane_of_rod[packing.lane_edge[i]] = static_cast<std::uint32_t>(i % packing.lanes);
  }

  std::vector<Edge> edges_;
  std::vector<std::uint8_t> none_common_;
  Islands islands_;
  Placement out_;
};

}  // namespace

Placement place_rods(const Scene& scene) {
  return Placer(scene).placed();
}

}  // namespace plumb::view
