#pragma once

#include <array>

#include "plumb/vec3.hpp"

namespace plumb::detail {

/// Holds one vector for each of two rods that meet, from a to b and from b to c.
struct RodPair {
  Vec3 first, second;
};

/// Returns the derivative of the twist between two rods (rad) by their vectors (m), in 1/m.
///
/// A cross section is carried from one rod to the next by the shortest turn that takes tangent p to q, and so
/// it is in time. When tangents turn they sweep an area of the sphere, (p x q) . (dp + dq)/(1 + p . q) with
/// its sign, by which the two ways differ (Bergou et al. 2008: holonomy). Rods that fold back on each other
/// beyond 165.6 degrees have no shortest turn; 1 + p . q stays 1/32 there.
///
/// With p and q in the middle of a substep, its product with the changes of vectors is the change of twist to
/// second order. Its torque about both rods is p - q, so that a closed chain has none.
RodPair twist_direction(const RodPair& rods);

/// Holds the derivatives of a direction: `of[r][s]`, by rows, is that of vector r by rod s, in 1/m².
struct TwistSlopes {
  std::array<std::array<std::array<double, 9>, 2>, 2> of{};
};
TwistSlopes twist_slopes(const RodPair& rods);

}  // namespace plumb::detail
