#pragma once

#include <array>
#include <span>

#include "plumb/export.hpp"
#include "plumb/vec3.hpp"

namespace plumb {

/// Holds a symmetric 3x3 tensor of inertia, in kg m².
struct Inertia {
  double xx = 0;  ///< Diagonal entry, in kg m².
  double yy = 0;  ///< Diagonal entry, in kg m².
  double zz = 0;  ///< Diagonal entry, in kg m².
  double xy = 0;  ///< Entry of the tensor, in kg m²: minus the integral of x y over the mass.
  double xz = 0;  ///< Entry of the tensor, in kg m².
  double yz = 0;  ///< Entry of the tensor, in kg m².

  /// Returns whether all entries are equal.
  friend constexpr bool operator==(const Inertia&, const Inertia&) = default;
};

/// Says what a rigid body weighs.
struct MassProperties {
  double mass = 0;    ///< Mass, in kg.
  Vec3 center{};      ///< Centre of mass, in m.
  Inertia inertia{};  ///< About that centre, in kg m², in the axes given.
};

/// Stands for a particle where only its mass and place count.
struct PointMass {
  Vec3 position{};  ///< Position, in m.
  double mass = 0;  ///< Mass, in kg.
};

/// Weighs a set of points. The centre follows thesis eq. 2.2, the inertia about it eq. 2.13 and 4.1.
///
/// A set without mass has its centre at the origin. Throws InputError with the number of a point whose mass
/// is negative or that is not finite.
PLUMB_API MassProperties mass_properties(std::span<const PointMass> points);

/// Weighs a cylinder of even density, centred on the origin with its axis along x (thesis eq. 4.2 to 4.4).
///
/// Lengths are in m, mass is in kg. All solids throw InputError on a size that is not positive and
/// finite, and on a mass that is negative or not finite.
PLUMB_API MassProperties solid_cylinder(double mass, double radius, double length);
/// Weighs a box with sides `size` (m) along the axes.
PLUMB_API MassProperties solid_box(double mass, Vec3 size);
/// Weighs a ball of `radius` (m).
PLUMB_API MassProperties solid_sphere(double mass, double radius);
/// Weighs a cylinder of `length` (m) along x with half a sphere on either end.
PLUMB_API MassProperties solid_capsule(double mass, double radius, double length);
/// Weighs a cylinder whose axis leads from `a` to `b` (m), in any direction. Its centre is between them.
/// Throws InputError on places that are the same or not finite, too.
PLUMB_API MassProperties solid_cylinder(double mass, double radius, Vec3 a, Vec3 b);
/// Weighs such a cylinder with half a sphere on either end: what a Capsule between `a` and `b` holds.
PLUMB_API MassProperties solid_capsule(double mass, double radius, Vec3 a, Vec3 b);

/// Returns the inertia (kg m²) about another point, `offset` (m) away from the centre of mass, by the theorem
/// of parallel axes.
PLUMB_API Inertia inertia_about(const MassProperties& body, Vec3 offset);

/// Returns four points of equal mass with exactly the mass, the centre of mass and the inertia given.
///
/// They are a regular tetrahedron, stretched along the principal axes. A flat body has them in a plane, a
/// thin one on a line. Throws InputError on a mass that is not positive and finite, and on anything else that
/// is not finite. It also refuses an inertia that no body has, in which one principal moment exceeds the sum
/// of the others.
PLUMB_API std::array<PointMass, 4> four_points(const MassProperties& body);

}  // namespace plumb
