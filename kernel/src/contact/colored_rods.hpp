#pragma once

#include <cstdint>
#include <span>

#include "plumb/layouts/memory.hpp"

namespace plumb::detail {

/// Holds the rigid rods of an island for sweeps. Rods of one colour share no movable particle.
struct ColoredRods {
  struct Rod {
    std::uint32_t a, b, number;
    double length2;  ///< m²
  };
  /// This is how an island lies whose rods join neighbours in rows and columns, all of them and no others, as
  /// those of a net do (layouts::detect_shape()). Others have none.
  struct Grid {
    std::uint32_t width = 0, height = 0;
    Array<std::uint32_t> particles{};  ///< (x, y) is at y·width + x
    /// From (x, y) to (x + 1, y) at y·(width − 1) + x, then to (x, y + 1) at y·width + x after all of those.
    Array<Rod> rods{};
  };

  std::uint32_t colors() const { return static_cast<std::uint32_t>(begin.size() - 1); }
  std::span<const Rod> of(std::uint32_t color) const {
    if (color >= colors()) return {};
    return std::span(rods).subspan(begin[color], begin[color + 1] - begin[color]);
  }

  Array<Rod> rods{};  ///< colour by colour
  Array<std::uint32_t> begin{0};
  Grid grid{};
};

}  // namespace plumb::detail
