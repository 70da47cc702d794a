#pragma once

#include <cstdint>
#include <span>
#include <string_view>

#include "plumb/layouts/coloring.hpp"
#include "plumb/layouts/graph.hpp"
#include "plumb/layouts/memory.hpp"
#include "plumb/layouts/shapes.hpp"

namespace plumb::layouts {

/// No edge: padding.
inline constexpr std::uint32_t none = ~std::uint32_t{0};

/// How the particles of a block lie in memory (stores.hpp).
enum class Layout : std::uint8_t { aos, soa, aosoa };

/// How a kernel finds the two ends of a vector of edges.
enum class Access : std::uint8_t {
  rows,     ///< `lanes` neighbouring numbers per component, with one address per vector.
  gather,   ///< Anywhere, with one address per edge; collected through the stack.
  records,  ///< Records x y z 0, with one address per edge; transposed in registers.
};

/// How positions (see Packing) depend on each other.
enum class Coupling : std::uint8_t {
  independent,  ///< Not at all: each position may finish all its sweeps before the next starts.
  neighbor,     ///< Edges of `across` stages join a position and the next: sweeps can be pipelined.
  whole,        ///< There is one position.
};

/// Vectors [begin, begin + count) of a position. All their edges may be projected at once.
struct Stage {
  std::uint32_t begin = 0;  ///< First vector.
  std::uint32_t count = 0;  ///< Number of vectors.
};

/// Where every particle and every edge of a block lies, and in which order edges are visited. It knows
/// nothing of what the numbers mean.
///
/// Edges come in vectors of `lanes`. A block is cut into `positions` along its length. Position q owns
/// vectors from q * position_vectors on, and in each of `streams` streams elements from q * position_elements
/// on. One sweep runs the stages in order.
struct Packing {
  std::string_view shape;               ///< Name of the shape, for reports.
  Layout layout = Layout::aos;          ///< How particles lie in memory.
  Access access = Access::records;      ///< How ends are found.
  Coupling coupling = Coupling::whole;  ///< How positions depend on each other.
  std::uint32_t lanes = 0;              ///< Edges per vector.
  std::uint32_t colors = 0;             ///< Colours that a sweep visits.

  std::uint32_t elements = 0;           ///< Numbers per particle array.
  std::uint32_t component_stride = 0;   ///< Elements from x to y and from y to z.
  std::uint32_t streams = 1;            ///< Streams of a particle array.
  std::uint32_t stream_pitch = 0;       ///< Elements from one stream to the next.
  std::uint32_t position_elements = 0;  ///< Elements of a position in each stream.
  Array<std::uint32_t> slot_offset;     ///< Element of each slot's x.
  Array<std::uint32_t> slot_vertex;     ///< The vertex that each slot holds.
  Array<std::uint32_t> slot_island;     ///< The island of that vertex.
  Array<std::uint8_t>
      slot_duplicate;  ///< 1 if another slot of this packing holds the same vertex for results.

  std::uint32_t positions = 1;         ///< Number of positions.
  std::uint32_t position_vectors = 0;  ///< Vectors of each.
  Array<Stage> stages;                 ///< Stages of a sweep, in order.
  std::uint32_t within_stages = 0;     ///< Stages inside a position; the rest are across stages.
  Array<std::uint32_t> address_a;      ///< Element of end a's x, per vector (rows) or per edge.
  Array<std::uint32_t> address_b;      ///< The same for end b.
  Array<std::uint32_t> lane_edge;      ///< Per lane the edge, or `none` for padding.

  /// Vectors of the whole block.
  std::uint32_t vectors() const { return positions * position_vectors; }
};

/// An island to pack: its vertices and edges by global id, in the order of its local graph.
struct Piece {
  std::uint32_t island = 0;                 ///< Number of the island.
  std::span<const std::uint32_t> vertices;  ///< Its vertices.
  std::span<const std::uint32_t> edges;     ///< Its edges.
};

/// The colours that every packing of an island uses: by rank along a chain, by direction and parity on a
/// grid, greedy otherwise. Packings of one island in different layouts therefore visit edges in an equivalent
/// order.
Coloring color_by_shape(const Graph& local, const ShapeInfo& shape);

/// Packs a chain as even and odd streams: edge k joins lane k/2 of one stream and of the other. Sweeps are
/// pipelined. `element_bytes` is 4 for float and 8 for double.
Packing pack_streams(const Piece& piece, const ShapeInfo& chain, std::uint32_t lanes,
                     std::uint32_t element_bytes);

/// Packs a chain cut into `lanes` segments, one per lane.
Packing pack_segments(const Piece& piece, const ShapeInfo& chain, std::uint32_t lanes);

/// Packs a grid cut into `lanes` strips of rows, one per lane. Positions are pairs of columns; sweeps are
/// pipelined.
Packing pack_strips(const Piece& piece, const ShapeInfo& grid, std::uint32_t lanes);

/// Packs islands with equal local graphs side by side, one per lane. Positions are lane groups of `lanes`
/// islands, the last filled with duplicates of the last island. Edges with `common[edge]`, by rank in the
/// local graph, come first within a colour.
Packing pack_lanes(std::span<const Piece> pieces, const Graph& local, const Coloring& coloring,
                   std::span<const std::uint8_t> common, std::uint32_t lanes);

/// Any island, with its local graph, colours and vertex order.
struct IndexedPiece {
  Piece piece;                        ///< Its vertices and edges.
  Graph local;                        ///< Its local graph.
  Coloring coloring;                  ///< Colours of its edges.
  Array<std::uint32_t> vertex_order;  ///< Order in memory; empty means as given.
};
/// Packs any islands in one block, with an address per edge. `common` is by global edge id; such edges come
/// first within a colour. `element_bytes` is 4 for float and 8 for double.
Packing pack_indexed(std::span<const IndexedPiece> pieces, Layout layout,
                     std::span<const std::uint8_t> common, std::uint32_t lanes, std::uint32_t element_bytes,
                     std::string_view shape);

}  // namespace plumb::layouts
