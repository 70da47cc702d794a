#pragma once

#include "contact/shapes/meshes/triangle_mesh.hpp"
#include "queries/probe.hpp"
#include "queries/things.hpp"

/// This file says how far places and boxes are from what queries find.
namespace plumb::detail {

/// Returns how far (m) a place is from a surface, negative inside of what is solid, and where the surface is
/// nearest.
Strike near_capsule(Vec3 place, Vec3 p, Vec3 q, double radius);
Strike near_plane(Vec3 place, const PlaneNow& plane);
Strike near_convex(Vec3 place, const Convex& shape);
/// Likewise of a mesh, unless it is farther than `most` (m): then nothing is met. What it encloses counts,
/// however deep.
Strike near_mesh(Vec3 place, const TriangleMesh& mesh, double most);
/// Likewise of anything in the list.
Strike near_thing(Vec3 place, const Things& things, const Thing& thing, double most);

/// Returns how a ball or a box that stays where it starts overlaps something, or nothing if it does not. The
/// distance is 0.
Strike overlap(const Probe& probe, const PlaneNow& plane);
Strike overlap(const Probe& probe, const Convex& shape);
Strike overlap(const Probe& probe, const TriangleMesh& mesh);
Strike overlap(const Probe& probe, const Things& things, const Thing& thing);

}  // namespace plumb::detail
