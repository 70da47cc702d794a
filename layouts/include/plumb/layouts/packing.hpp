#pragma once

#include <cstdint>
#include <span>
#include <string_view>
#include <vector>

#include "plumb/layouts/coloring.hpp"
#include "plumb/layouts/graph.hpp"
#include "plumb/layouts/shapes.hpp"

namespace plumb::layouts {

inline constexpr std::uint32_t none = ~std::uint32_t{0};

enum class Layout : std::uint8_t { aos, soa, aosoa };

/// How a kernel finds the two ends of a vector of edges.
enum class Access : std::uint8_t {
  rows,     ///< `lanes` neighbouring numbers per component; one address per vector
  gather,   ///< anywhere; one address per edge, collected through the stack
  records,  ///< x y z 0 records; one address per edge, transposed in registers
};

/// How positions (see Packing) depend on each other.
enum class Coupling : std::uint8_t {
  independent,  ///< not at all: each position may finish all its sweeps before the next starts
  neighbor,     ///< edges of `across` stages join a position and the next: sweeps can be pipelined over
                ///< positions
  whole,        ///< one position
};

/// Vectors [begin, begin + count) of a position, all edges of which may be projected at once.
struct Stage {
  std::uint32_t begin = 0;
  std::uint32_t count = 0;
};

/// Where every particle and every edge of a block lies, and in which order edges are visited. Knows nothing
/// of what the numbers mean.
///
/// Edges come in vectors of `lanes`. A block is cut into `positions` along its length; position q owns
/// vectors [q * position_vectors, (q + 1) * position_vectors) and, in each of `streams` streams, elements [q
/// * position_elements, (q + 1) * position_elements). One sweep runs the stages in order.
struct Packing {
  std::string_view shape;
  Layout layout = Layout::aos;
  Access access = Access::records;
  Coupling coupling = Coupling::whole;
  std::uint32_t lanes = 0;
  std::uint32_t colors = 0;

  std::uint32_t elements = 0;  ///< numbers per particle array
  std::uint32_t component_stride = 0;
  std::uint32_t streams = 1;
  std::uint32_t stream_pitch = 0;
  std::uint32_t position_elements = 0;
  std::vector<std::uint32_t> slot_offset;  ///< element of each slot's x
  std::vector<std::uint32_t> slot_vertex;  ///< the vertex each slot holds
  std::vector<std::uint32_t> slot_island;  ///< its island
  std::vector<std::uint8_t>
      slot_duplicate;  ///< 1: another slot of this packing holds the same vertex for results

  std::uint32_t positions = 1;
  std::uint32_t position_vectors = 0;
  std::vector<Stage> stages;
  std::uint32_t within_stages = 0;       ///< the rest are across stages
  std::vector<std::uint32_t> address_a;  ///< element of end a's x: per vector (rows) or per edge
  std::vector<std::uint32_t> address_b;
  std::vector<std::uint32_t> lane_edge;  ///< per lane: the edge, or `none` for padding

  std::uint32_t vectors() const { return positions * position_vectors; }
};

/// An island to pack: its vertices and edges by global id, in the order of its local graph.
struct Piece {
  std::uint32_t island = 0;
  std::span<const std::uint32_t> vertices;
  std::span<const std::uint32_t> edges;
};

/// The colours every packing of an island uses: by rank along a chain, by direction and parity on a grid,
/// greedy otherwise. Packings of the same island in different layouts therefore visit edges in an equivalent
/// order.
Coloring color_by_shape(const Graph& local, const ShapeInfo& shape);

/// Chain as even and odd streams: rod k joins lane k/2 of one stream and of the other. Pipelined.
Packing pack_streams(const Piece& piece, const ShapeInfo& chain, std::uint32_t lanes,
                     std::uint32_t element_bytes);

/// Chain cut into `lanes` segments, one per lane.
Packing pack_segments(const Piece& piece, const ShapeInfo& chain, std::uint32_t lanes);

/// Grid cut into `lanes` strips of rows, one per lane; positions are pairs of columns. Pipelined.
Packing pack_strips(const Piece& piece, const ShapeInfo& grid, std::uint32_t lanes);

/// Islands with equal local graphs side by side, one per lane; positions are groups of `lanes` islands.
/// The last group is filled with duplicates of the last island. Edges with `common[edge]` (by rank in the
/// local graph) come first within a colour.
Packing pack_lanes(std::span<const Piece> pieces, const Graph& local, const Coloring& coloring,
                   std::span<const std::uint8_t> common, std::uint32_t lanes);

/// Any islands, each with its local graph, colours and vertex order, in one block with an address per edge.
struct IndexedPiece {
  Piece piece;
  Graph local;
  Coloring coloring;
  std::vector<std::uint32_t> vertex_order;  ///< order in memory; empty: as given
};
/// `common` is by global edge id.
Packing pack_indexed(std::span<const IndexedPiece> pieces, Layout layout,
                     std::span<const std::uint8_t> common, std::uint32_t lanes, std::uint32_t element_bytes,
                     std::string_view shape);

}  // namespace plumb::layouts
