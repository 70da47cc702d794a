#pragma once

#include <array>

#include "plumb/vec3.hpp"

namespace plumb::detail {

/// Returns the unit quaternion w, x, y, z of the rotation nearest to a matrix with these columns, in the
/// Frobenius norm, also where that mirrors. It is the eigenvector of Davenport's matrix with the largest
/// eigenvalue (Horn, J. Opt. Soc. Am. A 4, 1987), within 1e-14. Where several are as near it is one of them.
std::array<double, 4> nearest_rotation(const std::array<Vec3, 3>& columns);

}  // namespace plumb::detail
