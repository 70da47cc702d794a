#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <numbers>
#include <optional>
#include <vector>

#include "plumb/export.hpp"
#include "plumb/inertia.hpp"
#include "plumb/vec3.hpp"

namespace plumb {

/// A point with mass. A fixed particle never moves by itself (inverse mass 0) and its mass is ignored.
struct Particle {
  Vec3 position{};  ///< m
  Vec3 velocity{};  ///< m/s
  double mass = 0;  ///< kg; a movable particle needs mass of its own or from its rods
  bool fixed = false;
  bool asleep = false;  ///< an island whose movable particles all are stands still until something touches it
};

/// Keeps particles `a` and `b` at `length`. Its own mass lies along it: evenly, unless `center` and `inertia`
/// say otherwise.
struct Rod {
  std::uint32_t a = 0;  ///< index into Scene::particles
  std::uint32_t b = 0;  ///< index into Scene::particles
  double length = 0;    ///< m; 0 means the distance between the two particles
  double mass = 0;      ///< kg; 0 is a massless link
  double center = 0.5;  ///< of its mass, as a fraction of the way from a to b
  std::optional<double>
      inertia{};  ///< kg m^2, about its centre of mass; none: evenly spread, mass length^2/12
  /// Of the air, in 1/s: a rod's velocity along its axis and across it decays at these rates (thesis 2.1.5,
  /// 2.1.6).
  double linear_drag = 0;
  double orthogonal_drag = 0;
};

/// A place that moves with a limb: a weighted mean of up to four particles. Weights add up to 1 (to 1e-9); a
/// place outside has negative ones. Slots with weight 0 are not read.
struct Point {
  std::array<std::uint32_t, 4> particles{};
  std::array<double, 4> weights{};
};

/// A rigid limb with a full tensor of inertia on four particles that do not lie in one plane; they are kept
/// apart by rods, which the scene lists like all others (add_body()): six, less those between two fixed
/// particles. Its mass acts on them by the exact kinetic energy, as that of a rod does on its two
/// (body_mass()), and adds to masses of their own.
struct Body {
  std::array<std::uint32_t, 4> particles{};
  double mass = 0;    ///< kg
  Vec3 center{};      ///< m, of mass, as the scene stands
  Inertia inertia{};  ///< kg m², about that centre, in the axes of space as the scene stands
};

/// Two places that coincide: a spherical joint that is not at a shared particle.
struct Pin {
  Point a{}, b{};
};

/// From one place to another: of the same limb, if its angle with another is meant; of two limbs, if it is
/// their distance along another.
struct Direction {
  Point from{}, to{};
};

/// Keeps the dot product of two directions (m²) as it is in the scene: a right angle, or a place in a plane.
/// One of the two may be of length zero, as that from a place in the plane to another.
struct Alignment {
  Direction u{}, v{};
};

/// What acts on the angle between two directions, which is in (0, pi): limits, dry friction, and a drive
/// towards a pose. Right angles are told best; near 0 and pi, where an angle has no derivative, not well.
struct AngleControl {
  Direction u{}, v{};
  double lower = 0, upper = std::numbers::pi;  ///< rad
  double friction = 0;                         ///< N m; the most that friction holds against
  double target = std::numbers::pi / 2;        ///< rad, of the drive
  double stiffness = 0;                        ///< N m/rad; 0: no drive
  double damping = 0;                          ///< N m s/rad
};

/// How something feels when touched. Of two surfaces the larger restitution counts, and the geometric mean of
/// their friction.
struct Surface {
  double friction = 0.5;   ///< Coulomb's coefficient
  double restitution = 0;  ///< 0 to 1; thesis eq. 2.32
};

/// The shape of a limb: all that is within `radius` of the line between two places; a sphere if they are the
/// same.
struct Capsule {
  Point a{}, b{};
  double radius = 0;  ///< m
  Surface surface{};
};

/// Solid ground: everything below it, normal·x < offset.
struct Plane {
  Vec3 normal{0, 1, 0};  ///< of length one
  double offset = 0;     ///< m
  Surface surface{};
};

/// A solid box that does not move.
struct Box {
  Vec3 center{};                                  ///< m
  Vec3 half_size{};                               ///< m
  std::array<double, 4> orientation{1, 0, 0, 0};  ///< unit quaternion w, x, y, z
  Surface surface{};
};

/// How a rod's mass acts on its two ends: as point masses there, with the right centre of mass but the
/// inertia of a dumbbell (the thesis), or by its exact kinetic energy, that of a straight thin rod.
enum class MassModel : std::uint8_t { lumped, consistent };

/// What a user describes, in double precision and in the user's own order.
struct Scene {
  std::vector<Particle> particles;
  std::vector<Rod> rods;
  Vec3 gravity{0, -9.81, 0};  ///< m/s²
  double drag = 0;            ///< 1/s; velocities decay as exp(-drag·t)
  /// 1/s; what an island does but for moving as a rigid whole decays at this rate: friction in all joints
  /// alike, which keeps momentum and angular momentum.
  double joint_drag = 0;

  std::vector<Body> bodies{};
  std::vector<Pin> pins{};
  std::vector<Alignment> alignments{};
  std::vector<AngleControl> angles{};
  std::vector<Capsule> capsules{};
  std::vector<Plane> planes{};
  std::vector<Box> boxes{};
};

/// Whether it has more than particles and rods: limbs that touch, bodies, joints, air on rods or sleepers.
/// Methods direct and automatic alone move such a scene.
PLUMB_API bool is_articulated(const Scene& scene);

/// Refuses a scene that cannot be simulated; throws InputError naming the particle, rod, body, joint or shape
/// by its number, and the reason:
/// non-finite numbers, negative mass or drag, a movable particle without mass, an unknown particle,
/// a rod from a particle to itself, zero or negative length, a duplicate rod, a rod with both ends fixed;
/// a body whose particles are in one plane (their volume 1e-9 of their size cubed) or lack a rod, or whose
/// inertia is not that of a solid; weights of a point that do not add up to 1; a pin or an alignment of
/// nothing that moves; an angle without directions or with limits outside [0, pi]; a negative radius, size or
/// friction; a normal or a quaternion that is not of length one (to 1e-9); restitution outside [0, 1].
PLUMB_API void validate(const Scene& scene);

/// The length of rod `i` in metres, with the default (distance between its particles) filled in.
PLUMB_API double rod_length(const Scene& scene, std::size_t i);

/// The mass matrix of a rod on its ends, in kg: its kinetic energy is aa/2 va·va + ab va·vb + bb/2 vb·vb.
/// Consistent: with s the fraction of the way from a to b, aa, ab and bb are the integrals of (1-s)^2, s(1-s)
/// and s^2 over its mass; evenly spread, mass/6 [[2, 1], [1, 2]]. Lumped: ab is 0.
struct RodMass {
  double aa = 0;
  double ab = 0;
  double bb = 0;
};
PLUMB_API RodMass rod_mass(const Scene& scene, std::size_t i, MassModel model);

/// The mass matrix of body `i` on its four particles, in kg: with M_jk its entries, the kinetic energy is
/// half the sum of M_jk v_j·v_k over all j and k, exactly that of the solid. A place x that moves with the
/// body has barycentric weights w_j(x) = a_j + b_j·(x - center), so M_jk, the integral of w_j w_k over the
/// mass, is mass a_j a_k + b_jᵀ S b_k, with S = tr(inertia)/2 1 - inertia its second moments about the
/// centre, kg m². The particles must not lie in one plane, as validate() has it.
PLUMB_API std::array<std::array<double, 4>, 4> body_mass(const Scene& scene, std::size_t i);

/// Mass of every particle in kg with its share of the lumped mass of its rods and a quarter of its bodies'.
/// Fixed particles get infinity.
PLUMB_API std::vector<double> lumped_masses(const Scene& scene);

/// Diagonal of the axis-aligned box around all particles, in metres: the length errors are relative to.
PLUMB_API double bounding_diagonal(const Scene& scene);

}  // namespace plumb
