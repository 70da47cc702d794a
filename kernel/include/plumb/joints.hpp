#pragma once

#include <array>
#include <cstdint>

#include "plumb/export.hpp"
#include "plumb/scene.hpp"

/// @file
/// This file makes bodies and the joints between them from shared particles, rods, ball joints and alignments
/// (thesis 3.2.5).
///
/// All joints are exact: what a joint forbids is zero to rounding. All functions take places and axes as the
/// scene stands, in m and in the axes of space. An axis may have any length but zero.
///
/// All functions throw InputError, before anything changes, on a rod, a body or a body's particle that is not
/// there. They also throw it on what is not finite. Points that are handed over are checked by validate()
/// only.
namespace plumb {

/// Returns the place of a particle.
PLUMB_API Point point_at(std::uint32_t particle);
/// Returns a place on the axis of a rod, `fraction` of the way from a to b. It may lie beyond the ends.
PLUMB_API Point point_on_rod(const Scene& scene, std::uint32_t rod, double fraction);
/// Returns a place anywhere on a body, by where it is now (m). Throws InputError if the body's particles lie
/// in one plane.
PLUMB_API Point point_on_body(const Scene& scene, std::uint32_t body, Vec3 position);

/// Returns a sphere of `radius` (m) around a place, as a capsule whose ends are both there.
PLUMB_API Capsule sphere_at(const Point& center, double radius);

/// Returns where a place is, as the scene stands, in m. The scene must hold its particles.
PLUMB_API Vec3 position_of(const Scene& scene, const Point& point);

/// Adds a body at rest with exactly the mass, the centre of mass and the inertia given, and returns its
/// number.
///
/// It adds four particles without mass and the six rods between them. Their mass matrix is diagonal. It is a
/// quarter of the mass on each, and they are those of four_points(), unless the body is thinner than a
/// hundredth of its length. Then one or two stand off it and weigh less: nothing, if the body is flat. Throws
/// InputError if the inertia is that of a line, or that of no body.
PLUMB_API std::uint32_t add_body(Scene& scene, const MassProperties& properties);
/// Adds a body on four particles of the scene. It adds the rods between them that are missing, except between
/// two anchors. It goes through all rods of the scene.
PLUMB_API std::uint32_t add_body(Scene& scene, const std::array<std::uint32_t, 4>& particles,
                                 const MassProperties& properties);

/// Returns the unit vectors into which a unit quaternion w, x, y, z turns the axes of space.
PLUMB_API std::array<Vec3, 3> axes_of(const std::array<double, 4>& orientation);

/// Returns a box on a body, as a hull. Its quaternion w, x, y, z turns it from the axes of space. Of its
/// eight corners, number 4 i + 2 j + k is on the far side along its own x, y and z where i, j and k are 1.
PLUMB_API Hull box_on_body(std::uint32_t body, const Box& box);

/// Adds a ball joint, which leaves three freedoms. Rods can also share a particle, which is cheaper.
PLUMB_API void add_spherical(Scene& scene, const Point& a, const Point& b);
/// Adds a hinge, which leaves one freedom: bodies a and b share the line through `position` along `axis`. It
/// is a ball joint and two alignments. Two ball joints would forbid the distance between them twice.
PLUMB_API void add_revolute(Scene& scene, std::uint32_t body_a, std::uint32_t body_b, Vec3 position,
                            Vec3 axis);
/// Adds a universal joint, which leaves two freedoms, about `axis_a` of body a and `axis_b` of body b. The
/// axes are at right angles, with a cosine of at most 1e-6. It is a ball joint and one alignment.
PLUMB_API void add_universal(Scene& scene, std::uint32_t body_a, std::uint32_t body_b, Vec3 position,
                             Vec3 axis_a, Vec3 axis_b);
/// Adds a slider, which leaves one freedom, along `axis` through `position`. It is five alignments: two keep
/// the place of b on the axis of a, three keep b from turning.
PLUMB_API void add_prismatic(Scene& scene, std::uint32_t body_a, std::uint32_t body_b, Vec3 position,
                             Vec3 axis);

}  // namespace plumb
