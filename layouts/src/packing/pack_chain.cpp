#include <algorithm>

#include "packing_builder.hpp"
#include "plumb/layouts/stores.hpp"

namespace plumb::layouts {
namespace {

// Vectors of each colour in a position: enough independent work to hide the latency of a projection, few
// enough that a dozen positions (one per sweep in flight) stay in the first two cache levels.
constexpr std::uint32_t vectors_per_position = 16;

// Segments cut each colour into stages, because rods without weights of their own are found by the stage: the
// anchor's rod and the padding of the last lane spoil only theirs. Every stage costs the start of a loop, and
// multiples of 8 leave its unrolled body no remainder.
constexpr std::uint32_t fewest_vectors_per_stage = 16;
constexpr std::uint32_t most_stages_per_color = 8;

/// True where the path comes back to a fixed vertex that it has listed before.
bool repeats(const ShapeInfo& chain, std::uint32_t rank) {
  return rank + 1 == chain.vertex_order.size() && rank > 0 &&
         chain.vertex_order[rank] == chain.vertex_order[0];
}

}  // namespace

Packing pack_streams(const Piece& piece, const ShapeInfo& chain, std::uint32_t lanes,
                     std::uint32_t element_bytes) {
  const auto edges = static_cast<std::uint32_t>(chain.edge_order.size());
  const std::uint32_t vectors = (edges / 2 + 1 + lanes - 1) / lanes;
  const std::uint32_t per_position = std::min(vectors, vectors_per_position);
  const std::uint32_t positions = (vectors + per_position - 1) / per_position;
  const SoaStore store(2 * positions * per_position * lanes, lanes, element_bytes, 2);

  detail::PackingBuilder builder("chain", Layout::soa, Access::rows, Coupling::neighbor, lanes);
  for (std::uint32_t i = 0; i <= edges; ++i)
    builder.add_slot(store.offset(i), piece.vertices[chain.vertex_order[i]], piece.island, repeats(chain, i));

  const std::uint32_t even = store.offset(0), odd = store.offset(1);
  for (std::uint32_t q = 0; q < positions; ++q) {
    for (const std::uint32_t parity : {0u, 1u}) {
      builder.begin_stage();
      for (std::uint32_t v = 0; v < per_position; ++v) {
        const std::uint32_t first = (q * per_position + v) * lanes;
        // Odd rods join the odd stream to the even one a lane further: rod 2j + 1 ends at particle 2j + 2.
        builder.add_row(parity ? odd + first : even + first, parity ? even + first + 1 : odd + first,
                        [&](std::uint32_t lane) {
                          const std::uint32_t rank = 2 * (first + lane) + parity;
                          return rank < edges ? piece.edges[chain.edge_order[rank]] : none;
                        });
      }
      builder.end_stage();
    }
    builder.end_position();
  }
  return builder.finish(store, 2, 1, per_position * lanes);
}

Packing pack_segments(const Piece& piece, const ShapeInfo& chain, std::uint32_t lanes) {
  const auto edges = static_cast<std::uint32_t>(chain.edge_order.size());
  // An even number of rows keeps the seam, from each lane's last row to the next lane's first, an odd rod.
  const std::uint32_t rows = round_up((edges + 1 + lanes - 1) / lanes, 2);
  const AosoaStore store(rows * lanes, lanes);

  detail::PackingBuilder builder("chain", Layout::aosoa, Access::rows, Coupling::whole, lanes);
  for (std::uint32_t i = 0; i <= edges; ++i)
    builder.add_slot(store.offset((i % rows) * lanes + i / rows), piece.vertices[chain.vertex_order[i]],
                     piece.island, repeats(chain, i));

  const auto edge_in_row = [&](std::uint32_t row, std::uint32_t lane) {
    const std::uint32_t rank = lane * rows + row;
    return rank < edges ? piece.edges[chain.edge_order[rank]] : none;
  };
  const std::uint32_t per_stage = std::max(
      fewest_vectors_per_stage, round_up((rows / 2 + most_stages_per_color - 1) / most_stages_per_color, 8));
  for (const std::uint32_t parity : {0u, 1u})
    for (std::uint32_t first = parity; first + 1 < rows; first += 2 * per_stage) {
      builder.begin_stage();
      for (std::uint32_t row = first; row + 1 < rows && row < first + 2 * per_stage; row += 2)
        builder.add_row(store.row_offset(row), store.row_offset(row + 1),
                        [&](std::uint32_t lane) { return edge_in_row(row, lane); });
      builder.end_stage();
    }
  builder.begin_stage();
  builder.add_row(store.row_offset(rows - 1), store.row_offset(0) + 1,
                  [&](std::uint32_t lane) { return lane + 1 < lanes ? edge_in_row(rows - 1, lane) : none; });
  builder.end_stage();
  builder.end_position();
  return builder.finish(store, 2);
}

}  // namespace plumb::layouts
