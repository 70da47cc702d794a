#pragma once

#include "plumb/export.hpp"
#include "plumb/inertia.hpp"
#include "plumb/vec3.hpp"

/// Two bodies that hit each other: the impulse method, thesis 2.5. The normal is of length one, from body b
/// to body a; restitution is from 0 to 1. All functions throw InputError, before anything changes, on a
/// normal that is not of length one (to 1e-9), restitution outside [0, 1], mass that is not positive,
/// anything else not finite, or two bodies of infinite mass.
namespace plumb {

/// How a body moves, and what it weighs. Infinite mass: nothing changes its motion, and its inertia is not
/// read.
struct RigidMotion {
  double mass = 0;          ///< kg
  Inertia inertia{};        ///< kg m², about the centre of mass, in the axes of space
  Vec3 center{};            ///< m, of mass
  Vec3 velocity{};          ///< m/s, of that centre
  Vec3 angular_velocity{};  ///< rad/s
};

/// The velocity of what is at `place` (m) of a body, in m/s: v + omega x r.
PLUMB_API Vec3 velocity_at(const RigidMotion& body, Vec3 place);

/// The impulse along the normal, in kg m/s, by thesis eq. 2.33: bodies that do not turn. Restitution (eq.
/// 2.32) is of the velocity at which they near each other, v_a·n - v_b·n; the thesis prints
/// -v_1·n - v_2·n, which would take two bodies side by side at one speed to collide. 0 if they part.
PLUMB_API double impulse(const RigidMotion& a, const RigidMotion& b, Vec3 normal, double restitution);
/// The same by thesis eq. 2.35: bodies that turn and touch at `contact` (m), with the velocities they have
/// there. Throws InputError also on an inertia that is not positive definite.
PLUMB_API double impulse(const RigidMotion& a, const RigidMotion& b, Vec3 contact, Vec3 normal,
                         double restitution);

/// The velocities after the impulse, by thesis eq. 2.34. Linear momentum is kept; energy is not gained.
PLUMB_API void collide(RigidMotion& a, RigidMotion& b, Vec3 normal, double restitution);
/// The same with spin, by thesis eq. 2.36 and 2.37, in which b gets the opposite of what a gets, as the text
/// before them says and its second line does not. Angular momentum is kept too.
PLUMB_API void collide(RigidMotion& a, RigidMotion& b, Vec3 contact, Vec3 normal, double restitution);

}  // namespace plumb
