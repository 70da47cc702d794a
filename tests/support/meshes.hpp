#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "scenes/basics/triangles.hpp"
#include "support/random_trees.hpp"

/// Meshes whose surface is known.
namespace plumb::test {

struct Mesh {
  std::vector<Vec3> vertices;
  std::vector<std::array<std::uint32_t, 3>> triangles;
};

/// A grid of cells x cells squares of `size` m about the origin, each two triangles that face upward, at the
/// heights of `height(x, z)`.
template <class Height>
Mesh landscape(std::uint32_t cells, double size, Height height) {
  Mesh out;
  for (std::uint32_t k = 0; k <= cells; ++k)
    for (std::uint32_t i = 0; i <= cells; ++i) {
      const double x = size * (i - 0.5 * cells), z = size * (k - 0.5 * cells);
      out.vertices.push_back({x, height(x, z), z});
    }
  out.triangles = scenes::grid_triangles(cells);
  return out;
}

/// A level floor whose vertices are shuffled along it, so that triangles have all kinds of edges.
inline Mesh shuffled_floor(std::uint32_t cells, double size, Random& random) {
  Mesh out = landscape(cells, size, [](double, double) { return 0.0; });
  for (Vec3& v : out.vertices) v += (0.2 * size) * Vec3{signed_unit(random), 0, signed_unit(random)};
  return out;
}

/// The surface of an L: a box of 2 x 1 x 1 m with another of 1 x 1 x 1 m on top of its half of least x. Its
/// triangles face outward, and it is concave along one edge.
inline Mesh l_shape() {
  Mesh out;
  const std::array<std::array<double, 2>, 6> outline{{{0, 0}, {2, 0}, {2, 1}, {1, 1}, {1, 2}, {0, 2}}};
  for (const double z : {0.0, 1.0})
    for (const auto& [x, y] : outline) out.vertices.push_back({x, y, z});
  for (std::uint32_t i = 0; i < 6; ++i) {
    const std::uint32_t k = (i + 1) % 6;
    out.triangles.push_back({i, i + 6, k + 6});
    out.triangles.push_back({i, k + 6, k});
  }
  // Lids fan out from the inner corner, number 3.
  for (const std::uint32_t i : {4u, 5u, 0u, 1u}) {
    const std::uint32_t k = (i + 1) % 6;
    out.triangles.push_back({3, i, k});
    out.triangles.push_back({9, k + 6, i + 6});
  }
  for (auto& [a, b, c] : out.triangles) std::swap(b, c);
  return out;
}

inline bool is_in_l(Vec3 p) {
  return p.z > 0 && p.z < 1 && p.x > 0 && p.y > 0 && ((p.x < 2 && p.y < 1) || (p.x < 1 && p.y < 2));
}

}  // namespace plumb::test
