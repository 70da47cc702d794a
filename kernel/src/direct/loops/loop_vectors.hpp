#pragma once

#include <cstddef>
#include <span>

#include "plumb/vec3.hpp"

namespace plumb::detail {

/// Vectors kept as three numbers each.
inline Vec3 at(std::span<const double> from, std::size_t i) {
  return {from[3 * i], from[3 * i + 1], from[3 * i + 2]};
}
inline void put(double* to, Vec3 v) {
  to[0] = v.x;
  to[1] = v.y;
  to[2] = v.z;
}

/// Returns by how much the square of the length of a rod along d grows if its ends come apart by e.
inline double growth_of(Vec3 d, Vec3 e) {
  return 2 * dot(d, e) + dot(e, e);
}

/// C = (|d + e|^2 - L^2)/2 of a rod whose ends were d apart and moved by e against each other, from small
/// numbers: `excess` is (|d|^2 - L^2)/2.
inline double constraint(Vec3 d, Vec3 e, double excess) {
  return excess + (dot(d, e) + 0.5 * dot(e, e));
}

}  // namespace plumb::detail
