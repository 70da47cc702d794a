#pragma once

#include <array>
#include <span>

#include "plumb/export.hpp"
#include "plumb/vec3.hpp"

namespace plumb {

/// A symmetric 3x3 tensor of inertia, kg m².
struct Inertia {
  double xx = 0, yy = 0, zz = 0;
  double xy = 0, xz = 0, yz = 0;

  friend constexpr bool operator==(const Inertia&, const Inertia&) = default;
};

/// What a rigid body weighs: mass in kg, centre of mass in m, inertia about that centre in the axes given.
struct MassProperties {
  double mass = 0;
  Vec3 center{};
  Inertia inertia{};
};

/// A particle for its mass alone.
struct PointMass {
  Vec3 position{};  ///< m
  double mass = 0;  ///< kg
};

/// Of a set of points: centre by thesis eq. 2.2, inertia by eq. 2.13 and 4.1, about the centre. A set without
/// mass has its centre at the origin. Throws InputError on a mass that is negative or anything not finite,
/// with the number of the point.
PLUMB_API MassProperties mass_properties(std::span<const PointMass> points);

/// Of solids of even density, centred on the origin, by the integrals of thesis eq. 4.2 to 4.4. Lengths in m,
/// mass in kg; the axis of cylinders and capsules is x. Throw InputError on a size that is not positive and
/// finite, or a mass that is negative or not finite.
PLUMB_API MassProperties solid_cylinder(double mass, double radius, double length);
PLUMB_API MassProperties solid_box(double mass, Vec3 size);
PLUMB_API MassProperties solid_sphere(double mass, double radius);
/// A cylinder of `length` with half a sphere on either end.
PLUMB_API MassProperties solid_capsule(double mass, double radius, double length);

/// The inertia about another point, `offset` (m) away from the centre of mass (parallel axes).
PLUMB_API Inertia inertia_about(const MassProperties& body, Vec3 offset);

/// Four points of equal mass with exactly the mass, the centre of mass and the inertia given: a tetrahedron
/// whose sides are those of a cube, stretched along the principal axes. A flat body has them in a plane, a
/// thin one on a line. Throws InputError on a mass that is not positive and finite, anything else not finite,
/// or an inertia that no body has: of whose principal moments one is larger than the other two together.
PLUMB_API std::array<PointMass, 4> four_points(const MassProperties& body);

}  // namespace plumb
