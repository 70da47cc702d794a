#pragma once

#include <cstdint>

#include "plumb/layouts/graph.hpp"
#include "plumb/layouts/memory.hpp"

namespace plumb::layouts {

/// What an island looks like.
enum class Shape : std::uint8_t { chain, grid, graph };

/// A shape and the order of vertices and edges along it. The orders are empty for Shape::graph.
struct ShapeInfo {
  Shape shape = Shape::graph;         ///< The shape.
  Array<std::uint32_t> vertex_order;  ///< Vertices along it.
  Array<std::uint32_t> edge_order;    ///< Edges along it.
  std::uint32_t width = 0;            ///< Width of a grid, in vertices.
  std::uint32_t height = 0;           ///< Height of a grid, in vertices.
};

/// Finds what one island looks like, whatever the numbering of its vertices and edges.
///
/// `island` is connected and has no edge between two fixed vertices. The search takes linear time and is
/// deterministic.
///
/// A chain is a path of at least one edge whose inner vertices are movable. vertex_order goes from one end to
/// the other and has one entry more than there are edges. edge_order[k] joins its entries k and k + 1. It
/// starts at a fixed end if there is one, of equals at the one with the smaller id. Both ends may be one
/// fixed vertex, which is then listed twice; the path leaves it by the edge with the smaller id.
///
/// A grid is a lattice of width × height vertices, both at least 2. It has the edges between horizontal and
/// vertical neighbours, all of them and no others. Fixed vertices count as ordinary ones. vertex_order is row
/// by row: (x, y) is at y·width + x. edge_order holds first the horizontal edges, with (x, y)–(x + 1, y) at
/// y·(width − 1) + x. The vertical ones follow, with (x, y)–(x, y + 1) at y·width + x after the last
/// horizontal. Rows run along the side on which ids of movable neighbours differ less. Both sides run towards
/// larger ids. A lattice that is numbered row by row therefore keeps its order, even if fixed vertices were
/// renumbered to the end.
///
/// A graph is anything else. A ring of four is a grid of 2 × 2 unless a vertex is fixed, which makes it a
/// chain.
ShapeInfo detect_shape(const Graph& island);

}  // namespace plumb::layouts
