#pragma once

#include <array>
#include <cstddef>

#include "plumb/scene.hpp"

/// This file has what is particular about bodies that are flat or thin, such as a disc or a wire.
namespace plumb::detail {

/// Returns four places that are a well-shaped tetrahedron however flat or thin a body is, in m. Point masses
/// in them have exactly the body's mass, centre of mass and inertia. The body must pass require_solid().
///
/// Of a solid they are those of four_points(), and weigh the same. Where a body is thin, one or two of them
/// stand off it, and weigh the less the thinner it is. That off a flat body weighs nothing.
std::array<Vec3, 4> body_points(const MassProperties& body);

/// Returns whether the mass matrix of a body's movable particles is singular, or nearly so.
///
/// Four particles move in twelve ways. In some of them a flat body has no inertia, and its rods alone forbid
/// these.
bool has_singular_mass(const Scene& scene, std::size_t body);

/// Returns the mass (kg) by which a particle of such a body counts where sizes of moves are estimated.
inline double nominal_mass(const Body& body) {
  return body.mass / 4;
}

}  // namespace plumb::detail
