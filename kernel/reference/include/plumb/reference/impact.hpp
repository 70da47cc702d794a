#pragma once

#include "plumb/export.hpp"
#include "plumb/inertia.hpp"
#include "plumb/vec3.hpp"

/// @file
/// This file computes how two bodies hit each other, by the impulse method of thesis 2.5.
///
/// The normal is a unit vector from body b to body a; restitution is from 0 to 1. All functions throw
/// InputError before anything changes. They refuse a normal that is not of length one (to 1e-9), restitution
/// outside [0, 1], and mass that is not positive. They also refuse two bodies of infinite mass and anything
/// else that is not finite.
namespace plumb {

/// Says how a body moves, and what it weighs. Nothing changes the motion of an infinite mass, whose inertia
/// is not read.
struct RigidMotion {
  double mass = 0;          ///< Mass, in kg.
  Inertia inertia{};        ///< About the centre of mass, in kg m², in the axes of space.
  Vec3 center{};            ///< Centre of mass, in m.
  Vec3 velocity{};          ///< Velocity of that centre, in m/s.
  Vec3 angular_velocity{};  ///< Angular velocity, in rad/s.
};

/// Returns the velocity of what is at `place` (m) of a body, in m/s: v + omega x r.
PLUMB_API Vec3 velocity_at(const RigidMotion& body, Vec3 place);

/// Returns the impulse along the normal, in kg m/s, of bodies that do not turn (thesis eq. 2.33). It is 0 if
/// they part.
///
/// Restitution (eq. 2.32) acts on the velocity at which they near each other, v_a·n - v_b·n. The thesis
/// prints -v_1·n - v_2·n, by which two bodies side by side at one speed would collide.
PLUMB_API double impulse(const RigidMotion& a, const RigidMotion& b, Vec3 normal, double restitution);
/// Returns the impulse of bodies that turn and touch at `contact` (m), from the velocities they have there
/// (eq. 2.35). Throws InputError also on an inertia that is not positive definite.
PLUMB_API double impulse(const RigidMotion& a, const RigidMotion& b, Vec3 contact, Vec3 normal,
                         double restitution);

/// Sets the velocities after the impulse (thesis eq. 2.34). Linear momentum is kept; energy is not gained.
PLUMB_API void collide(RigidMotion& a, RigidMotion& b, Vec3 normal, double restitution);
/// Sets the velocities after the impulse for bodies that turn (thesis eq. 2.36 and 2.37). Angular momentum is
/// kept too.
///
/// Body b gets the opposite of what a gets, as the text before these equations says. Their second line does
/// not.
PLUMB_API void collide(RigidMotion& a, RigidMotion& b, Vec3 contact, Vec3 normal, double restitution);

}  // namespace plumb
