#include <algorithm>

#include "packing_builder.hpp"
#include "plumb/layouts/stores.hpp"

namespace plumb::layouts {

Packing pack_lanes(std::span<const Piece> pieces, const Graph& local, const Coloring& coloring,
                   std::span<const std::uint8_t> common, std::uint32_t lanes) {
  const auto islands = static_cast<std::uint32_t>(pieces.size());
  const std::uint32_t groups = (islands + lanes - 1) / lanes;
  const AosoaStore store(groups * local.vertices * lanes, lanes);
  const auto piece_at = [&](std::uint32_t group, std::uint32_t lane) -> const Piece& {
    return pieces[std::min(group * lanes + lane, islands - 1)];
  };

  detail::PackingBuilder builder("lanes", Layout::aosoa, Access::rows, Coupling::independent, lanes);
  for (std::uint32_t group = 0; group < groups; ++group) {
    for (std::uint32_t vertex = 0; vertex < local.vertices; ++vertex)
      for (std::uint32_t lane = 0; lane < lanes; ++lane) {
        const Piece& piece = piece_at(group, lane);
        builder.add_slot(store.row_offset(group * local.vertices + vertex) + lane, piece.vertices[vertex],
                         piece.island, group * lanes + lane >= islands);
      }
    for (std::uint32_t color = 0; color < coloring.colors; ++color)
      for (const bool is_common : {true, false}) {
        builder.begin_stage();
        for (std::uint32_t edge = 0; edge < local.edges.size(); ++edge) {
          if (coloring.color_of_edge[edge] != color || static_cast<bool>(common[edge]) != is_common) continue;
          builder.add_row(store.row_offset(group * local.vertices + local.edges[edge].a),
                          store.row_offset(group * local.vertices + local.edges[edge].b),
                          [&](std::uint32_t lane) { return piece_at(group, lane).edges[edge]; });
        }
        builder.end_stage();
      }
    builder.end_position();
  }
  return builder.finish(store, coloring.colors, 0, local.vertices * 3 * lanes);
}

}  // namespace plumb::layouts
