#pragma once

#include "contact/shapes/passing.hpp"
#include "simd/relax/relax_kernels.hpp"

namespace plumb::detail {

/// This is how the line of a body moves, from a crowd's origin, in the order of simd::line_fields.
struct alignas(64) PlacedLine {
  Vec3 p{};
  double radius = 0;
  Vec3 q{};
  double moves = 0;  ///< m, how far its ends do at most
  Vec3 p_by{};
  double unused = 0;
  Vec3 q_by{};
  double unused_too = 0;
  MovingSegment way() const { return {{p, q, radius}, p_by, q_by}; }
};
static_assert(sizeof(PlacedLine) == simd::line_fields::count * sizeof(double));

}  // namespace plumb::detail
