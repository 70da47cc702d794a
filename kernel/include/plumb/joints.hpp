#pragma once

#include <cstdint>

#include "plumb/export.hpp"
#include "plumb/scene.hpp"

/// Limbs and the joints between them, from shared particles, virtual rods, pins and alignments (thesis
/// 3.2.5). All are exact: what a joint forbids is zero to rounding. All take places and axes as the scene
/// stands, in m and in the axes of space; an axis may be of any length but zero. All throw InputError, before
/// anything changes, on a rod, a body or a body's particle that is not there and on what is not finite;
/// points that are handed over wait for validate().
namespace plumb {

/// The place of a particle.
PLUMB_API Point point_at(std::uint32_t particle);
/// On the axis of a rod, `fraction` of the way from a to b; also beyond its ends.
PLUMB_API Point point_on_rod(const Scene& scene, std::uint32_t rod, double fraction);
/// Anywhere on a body, by where it is now (m). Throws InputError if its particles lie in one plane.
PLUMB_API Point point_on_body(const Scene& scene, std::uint32_t body, Vec3 position);

/// Where a place is, as the scene stands, in m. Its particles must be there.
PLUMB_API Vec3 position_of(const Scene& scene, const Point& point);

/// Adds four particles without mass and six rods, at rest, on which a body carries exactly the mass, the
/// centre of mass and the inertia given, and returns its number. The particles are those of four_points(), so
/// that its mass matrix is a quarter of its mass on each. Throws InputError if the inertia is not that of a
/// solid: a plate or a line, or thinner than 1e-9 of its size cubed (validate()).
PLUMB_API std::uint32_t add_body(Scene& scene, const MassProperties& properties);
/// The same on particles that are there; of the rods between them, those that are missing are added, except
/// between two fixed particles. Goes through all rods of the scene.
PLUMB_API std::uint32_t add_body(Scene& scene, const std::array<std::uint32_t, 4>& particles,
                                 const MassProperties& properties);

/// Three freedoms, by one pin. Rods can also share a particle, which is cheaper.
PLUMB_API void add_spherical(Scene& scene, const Point& a, const Point& b);
/// One freedom, to turn: bodies a and b share the line through `position` along `axis`. A pin and two
/// alignments; two pins would forbid the distance between them twice.
PLUMB_API void add_revolute(Scene& scene, std::uint32_t body_a, std::uint32_t body_b, Vec3 position,
                            Vec3 axis);
/// Two freedoms, to turn: about `axis_a` of body a and `axis_b` of body b, which are at right angles (their
/// cosine at most 1e-6). A pin and one alignment.
PLUMB_API void add_universal(Scene& scene, std::uint32_t body_a, std::uint32_t body_b, Vec3 position,
                             Vec3 axis_a, Vec3 axis_b);
/// One freedom, to slide along `axis` through `position`. Five alignments: two keep the place of b on the
/// axis of a, three keep b from turning.
PLUMB_API void add_prismatic(Scene& scene, std::uint32_t body_a, std::uint32_t body_b, Vec3 position,
                             Vec3 axis);

}  // namespace plumb
