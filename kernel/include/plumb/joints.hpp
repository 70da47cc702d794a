#pragma once

#include <cstdint>

#include "plumb/scene.hpp"

/// Limbs and the joints between them, from shared particles, virtual rods, pins and alignments (thesis
/// 3.2.5). All are exact: what a joint forbids is zero to rounding.
namespace plumb {

/// The place of a particle.
Point point_at(std::uint32_t particle);
/// On the axis of a rod, `fraction` of the way from a to b; also beyond its ends.
Point point_on_rod(const Scene& scene, std::uint32_t rod, double fraction);
/// Anywhere on a body, by where it is now (m). Throws InputError if its particles lie in one plane.
Point point_on_body(const Scene& scene, std::uint32_t body, Vec3 position);

/// Where a place is, as the scene stands, in m.
Vec3 position_of(const Scene& scene, const Point& point);

/// Adds four particles and six rods that carry exactly the mass, the centre of mass and the inertia given
/// (positions and axes of space); the body's number. Throws InputError if the inertia is not that of a solid.
std::uint32_t add_body(Scene& scene, const MassProperties& properties);
/// The same on particles that are there; of the rods between them, those that are missing are added.
std::uint32_t add_body(Scene& scene, const std::array<std::uint32_t, 4>& particles,
                       const MassProperties& properties);

/// Three freedoms. Rods can also share a particle, which is cheaper.
void add_spherical(Scene& scene, const Point& a, const Point& b);
/// One freedom, to turn: bodies a and b share the line through `position` along `axis`.
void add_revolute(Scene& scene, std::uint32_t body_a, std::uint32_t body_b, Vec3 position, Vec3 axis);
/// Two freedoms, to turn: about `axis_a` of body a and `axis_b` of body b, which are at right angles.
void add_universal(Scene& scene, std::uint32_t body_a, std::uint32_t body_b, Vec3 position, Vec3 axis_a,
                   Vec3 axis_b);
/// One freedom, to slide along `axis` through `position`.
void add_prismatic(Scene& scene, std::uint32_t body_a, std::uint32_t body_b, Vec3 position, Vec3 axis);

}  // namespace plumb
