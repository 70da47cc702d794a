#pragma once

#include <array>
#include <cstdint>

#include "plumb/vec3.hpp"

/// This file finds the point of a simplex that is nearest to the origin, with its weights on the corners.
namespace plumb::detail {

/// Holds up to four points and the weights of one place among them.
struct Simplex {
  std::array<Vec3, 4> points{};
  std::array<std::uint64_t, 4> names{};  ///< by point, for those who call
  std::array<double, 4> weights{};
  std::uint32_t count = 0;

  Vec3 place() const {
    Vec3 out{};
    for (std::uint32_t i = 0; i < count; ++i) out += weights[i] * points[i];
    return out;
  }
};

/// Weighs the points of the simplex for the place that is nearest to the origin, and drops those of weight
/// zero. Returns false, and drops none, if the origin is within a tetrahedron.
bool reduce_to_nearest(Simplex& simplex);

}  // namespace plumb::detail
