#pragma once

#include <array>

#include "plumb/inertia.hpp"
#include "reference/multipliers/small_matrices.hpp"

/// This file turns tensors of inertia into second moments, the integrals of r rᵀ over mass or points, and
/// finds principal axes.
namespace plumb::detail {

inline bool is_finite(const Inertia& i) {
  return is_finite(Vec3{i.xx, i.yy, i.zz}) && is_finite(Vec3{i.xy, i.xz, i.yz});
}

/// Returns tr(inertia)/2 1 - inertia, in kg m², about the same point.
Sym3 second_moments(const Inertia& inertia);

/// Describes a symmetric matrix by its principal axes, with moments in ascending order.
struct Principal {
  std::array<Vec3, 3> axis;  ///< unit vectors at right angles
  std::array<double, 3> moment;
};
/// Finds the principal axes of a matrix whose entries are finite.
Principal principal_axes(const Sym3& m);

}  // namespace plumb::detail
