#pragma once

#include <array>

#include "plumb/inertia.hpp"
#include "reference/multipliers/small_matrices.hpp"

/// Second moments, the integrals of r rᵀ over mass or points: what a tensor of inertia says in other words.
namespace plumb::detail {

inline bool is_finite(const Inertia& i) {
  return is_finite(Vec3{i.xx, i.yy, i.zz}) && is_finite(Vec3{i.xy, i.xz, i.yz});
}

/// tr(inertia)/2 1 - inertia, in kg m², about the same point.
Sym3 second_moments(const Inertia& inertia);

/// A symmetric matrix by its principal axes, moments in ascending order.
struct Principal {
  std::array<Vec3, 3> axis;  ///< of length one, at right angles
  std::array<double, 3> moment;
};
/// Of a matrix whose entries are finite.
Principal principal_axes(const Sym3& m);

}  // namespace plumb::detail
