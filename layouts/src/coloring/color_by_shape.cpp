#include "plumb/layouts/packing.hpp"

namespace plumb::layouts {

Coloring color_by_shape(const Graph& local, const ShapeInfo& shape) {
  if (shape.shape == Shape::graph) return color_edges(local);
  Coloring coloring;
  coloring.color_of_edge.resize(local.edges.size());
  if (shape.shape == Shape::chain) {
    for (std::uint32_t rank = 0; rank < shape.edge_order.size(); ++rank)
      coloring.color_of_edge[shape.edge_order[rank]] = rank % 2;
    coloring.colors = local.edges.size() > 1 ? 2 : 1;
    return coloring;
  }
  const std::uint32_t width = shape.width, height = shape.height;
  const std::uint32_t horizontals = height * (width - 1);
  for (std::uint32_t rank = 0; rank < shape.edge_order.size(); ++rank) {
    const bool horizontal = rank < horizontals;
    const std::uint32_t along = horizontal ? rank % (width - 1) : (rank - horizontals) / width;
    coloring.color_of_edge[shape.edge_order[rank]] = (horizontal ? 2 : 0) + along % 2;
  }
  coloring.colors = 4;
  return coloring;
}

}  // namespace plumb::layouts
