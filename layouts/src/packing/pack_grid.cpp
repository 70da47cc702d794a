#include "packing_builder.hpp"
#include "plumb/layouts/stores.hpp"

namespace plumb::layouts {

Packing pack_strips(const Piece& piece, const ShapeInfo& grid, std::uint32_t lanes) {
  const std::uint32_t width = grid.width, height = grid.height;
  // Each lane holds `rows` neighbouring rows of the grid. An even number keeps the parity of a row in its
  // strip the parity of the row in the grid, so that the seam between strips belongs to the odd vertical
  // colour.
  const std::uint32_t rows = round_up((height + lanes - 1) / lanes, 2);
  const std::uint32_t columns = round_up(width, 2);
  const AosoaStore store(columns * rows * lanes, lanes);
  const auto row_at = [&](std::uint32_t column, std::uint32_t row) {
    return store.row_offset(column * rows + row);
  };

  detail::PackingBuilder builder("grid", Layout::aosoa, Access::rows, Coupling::neighbor, lanes);
  for (std::uint32_t y = 0; y < height; ++y)
    for (std::uint32_t x = 0; x < width; ++x)
      builder.add_slot(row_at(x, y % rows) + y / rows, piece.vertices[grid.vertex_order[y * width + x]],
                       piece.island);

  const auto horizontal = [&](std::uint32_t column, std::uint32_t row) {
    return [&, column, row](std::uint32_t lane) {
      const std::uint32_t y = lane * rows + row;
      return column + 1 < width && y < height ? piece.edges[grid.edge_order[y * (width - 1) + column]] : none;
    };
  };
  const auto vertical = [&](std::uint32_t column, std::uint32_t row) {
    return [&, column, row](std::uint32_t lane) {
      const std::uint32_t y = lane * rows + row;
      return column < width && y + 1 < height
                 ? piece.edges[grid.edge_order[height * (width - 1) + y * width + column]]
                 : none;
    };
  };

  for (std::uint32_t left = 0; left < columns; left += 2) {
    const std::uint32_t right = left + 1;
    for (const std::uint32_t parity : {0u, 1u}) {
      builder.begin_stage();
      for (const std::uint32_t column : {left, right})
        for (std::uint32_t row = parity; row + 1 < rows; row += 2)
          builder.add_row(row_at(column, row), row_at(column, row + 1), vertical(column, row));
      builder.end_stage();
    }
    builder.begin_stage();  // the seam: each strip's last row to the first row of the next lane's strip
    for (const std::uint32_t column : {left, right})
      builder.add_row(row_at(column, rows - 1), row_at(column, 0) + 1, vertical(column, rows - 1));
    builder.end_stage();
    builder.begin_stage();
    for (std::uint32_t row = 0; row < rows; ++row)
      builder.add_row(row_at(left, row), row_at(right, row), horizontal(left, row));
    builder.end_stage();
    builder.begin_stage();  // across, to the next pair of columns; the last pair has only padding here
    for (std::uint32_t row = 0; row < rows; ++row)
      builder.add_row(row_at(right, row), row_at(right + 1 < columns ? right + 1 : left, row),
                      horizontal(right, row));
    builder.end_stage();
    builder.end_position();
  }
  return builder.finish(store, 4, 1, 2 * rows * 3 * lanes);
}

}  // namespace plumb::layouts
