#pragma once

#include <array>
#include <cstdint>
#include <vector>

namespace plumb::scenes {

/// Returns the triangles of a square grid of cells x cells squares, two in each, which face upward. Vertices
/// are numbered along x, line after line along z.
inline std::vector<std::array<std::uint32_t, 3>> grid_triangles(std::uint32_t cells) {
  std::vector<std::array<std::uint32_t, 3>> out;
  const std::uint32_t line = cells + 1;
  for (std::uint32_t k = 0; k < cells; ++k)
    for (std::uint32_t i = 0; i < cells; ++i) {
      const std::uint32_t a = k * line + i;
      out.push_back({a, a + line, a + line + 1});
      out.push_back({a, a + line + 1, a + 1});
    }
  return out;
}

}  // namespace plumb::scenes
