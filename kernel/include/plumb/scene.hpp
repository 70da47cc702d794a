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
#include "plumb/shapes/ground.hpp"
#include "plumb/shapes/surface.hpp"
#include "plumb/vec3.hpp"

namespace plumb {

/// This is a point with mass. A fixed particle, an anchor, never moves by itself. Its inverse mass is 0 and
/// its mass is ignored.
struct Particle {
  Vec3 position{};     ///< Position, in m.
  Vec3 velocity{};     ///< Velocity, in m/s.
  double mass = 0;     ///< Mass in kg. A movable particle needs mass of its own or from its rods.
  bool fixed = false;  ///< Whether it is an anchor.
  /// An island whose movable particles all sleep stands still until something touches it.
  bool asleep = false;

  /// Returns whether all members are equal.
  friend constexpr bool operator==(const Particle&, const Particle&) = default;
};

/// Says how a rod answers to what pulls on it. By default it is rigid: it keeps its length.
///
/// A rod of finite stiffness is elastic. At length l it pulls with stiffness (l - length) + damping dl/dt, in
/// N (Hooke; Kelvin and Voigt). A bar of cross section A and modulus E has the stiffness E A/length.
struct RodLaw {
  double stiffness = std::numeric_limits<double>::infinity();  ///< Stiffness, in N/m; infinity is rigid.
  double damping = 0;                                          ///< Damping along an elastic rod, in N s/m.
  bool one_sided = false;  ///< Whether it is a cable, which pulls, never pushes, and may be slack.
  /// Pull at which the rod breaks, in N; infinity means never. A broken rod pulls nothing any more.
  double strength = std::numeric_limits<double>::infinity();

  /// Returns whether the rod keeps its length, pulls and pushes, and never breaks.
  constexpr bool is_rigid() const { return *this == RodLaw{}; }
  /// Returns whether the rod has a finite stiffness.
  constexpr bool is_elastic() const { return stiffness < std::numeric_limits<double>::infinity(); }

  /// Returns whether all members are equal.
  friend constexpr bool operator==(const RodLaw&, const RodLaw&) = default;
};

/// Keeps particles `a` and `b` at `length`, or pulls them there as `law` says. Its own mass lies evenly along
/// it, unless `center` and `inertia` say otherwise.
struct Rod {
  std::uint32_t a = 0;  ///< Index into Scene::particles.
  std::uint32_t b = 0;  ///< Index into Scene::particles.
  /// Length in m; 0 means the distance between the two particles. Where it differs from that distance, a
  /// rigid rod brings them there: solved directly before the first step, and relaxed within it. Nothing is
  /// refused, however far that is; WorldInfo::projected_position says how far particles went.
  double length = 0;
  double mass = 0;      ///< Mass in kg; 0 is a massless link.
  double center = 0.5;  ///< Centre of its mass, as a fraction of the way from a to b.
  std::optional<double>
      inertia{};  ///< About its centre of mass, in kg m². None: evenly spread, mass · length²/12.
  /// Air slows the rod along its axis at this rate, in 1/s (thesis 2.1.5).
  double linear_drag = 0;
  /// Air slows the rod across its axis at this rate, in 1/s (thesis 2.1.6).
  double orthogonal_drag = 0;
  RodLaw law{};  ///< How it answers to what pulls on it.

  /// Returns whether all members are equal.
  friend constexpr bool operator==(const Rod&, const Rod&) = default;
};

/// Resists bending where the rods from `a` to `b` and from `b` to `c` meet, as a wire, a beam or a hair does.
///
/// Its energy is stiffness/2 (kappa(phi) - kappa(angle))^2, in J, with phi the angle between the directions
/// from a to b and from b to c. kappa(phi) = 2 tan(phi/2) is the curvature of discrete elastic rods (Bergou
/// et al. 2008), which is phi up to phi^3/12. It grows steeply as one rod folds back on the other, so that
/// the bend does not let go, and its square is algebraic. Above 165.6 degrees that square goes on along its
/// tangent and stays finite.
///
/// A beam of bending stiffness E I has E I/l at b. There l is its Voronoi length, the length of beam nearest
/// to b: half of either rod. At a clamped end it is half of one rod alone, because there is no beam beyond.
/// Such chains converge to Euler's elastica with order 2 in l.
///
/// An end is clamped at b if a and b are fixed, which then need no rod between them. Bends have no twist.
struct Bend {
  std::uint32_t a = 0;   ///< Index into Scene::particles.
  std::uint32_t b = 0;   ///< Index into Scene::particles, the one between the others.
  std::uint32_t c = 0;   ///< Index into Scene::particles.
  double stiffness = 0;  ///< Stiffness, in N m.
  double angle = 0;      ///< Angle phi at rest, in rad; 0 is straight. It has no plane of its own.
  double damping = 0;    ///< Torque per rate of phi, in N m s.

  /// Returns whether all members are equal.
  friend constexpr bool operator==(const Bend&, const Bend&) = default;
};

/// This is a place that moves with a body or a rod: a weighted mean of up to four particles.
///
/// Weights add up to 1, to within 1e-9. A place outside has negative weights. Slots with weight 0 are not
/// read.
struct Point {
  std::array<std::uint32_t, 4> particles{};  ///< Indices into Scene::particles.
  std::array<double, 4> weights{};           ///< Weights, in the order of `particles`.
};

/// Resists being twisted: a chain of rods whose cross sections turn against each other along it, as those of
/// a wire, a hose or a hair do. It bends nothing; Scene::bends do.
///
/// The twist is spread evenly, as it is once torsional waves, which are fast, have died out. Its energy is
/// stiffness/2 theta^2/length, in J. theta is the total twist in rad, right-handed along the chain, and
/// `length` that of its rods (Langer and Singer 1996; Bergou et al. 2008).
///
/// The first and the last rod do not spin about themselves. theta is `angle` as the scene stands, and then
/// follows from how the rods turn: it changes by the areas that tangents of neighbours sweep on the sphere.
/// A wire whose tangent goes round a cone is twisted that way. Whatever holds an end carries its torque
/// stiffness theta/length along the last rod. In a ring that is the first rod, so that nothing needs to.
struct Twist {
  /// Indices into Scene::particles, along the chain. There is a rod between each two; fixed neighbours, which
  /// clamp an end, need none. A ring ends where it starts.
  std::vector<std::uint32_t> particles{};
  double stiffness = 0;  ///< Torsional stiffness G J, in N m².
  double angle = 0;      ///< Angle by which the last cross section is turned against the first, in rad.
};

/// This is a massless cord that runs over particles in their order, which are its pulleys. The sum of the
/// distances between neighbours is its length, and without friction its pull is the same everywhere.
///
/// Pulleys have no size. One that is fixed hangs from the ceiling. A cord may run over a particle more than
/// once, as over several sheaves.
///
/// With friction the pulls on both sides of a pulley may differ by the factor exp(friction angle) (Euler and
/// Eytelwein). The cord turns there by that angle: 0 where it goes straight on, pi where it returns. Pulls
/// do differ by the factor while the cord slides, against its slide. Otherwise it sticks.
///
/// Such a cord is wound at its first particle, and stretches there. Its law says how the first segment pulls,
/// and what lies behind slides as a cord that keeps its length.
struct Tackle {
  std::vector<std::uint32_t> particles{};  ///< Indices into Scene::particles; neighbours differ.
  double length = 0;                       ///< Length in m; 0 means that of the scene as it stands.
  RodLaw law{};         ///< How it answers to what pulls on it, as a rod does. It has no strength.
  double friction = 0;  ///< Coulomb's coefficient between the cord and all its pulleys.

  /// Returns whether all members are equal.
  friend bool operator==(const Tackle&, const Tackle&) = default;
};

/// Pays out and takes in a chain of particles through one place, as a winch's drum does with a rope.
///
/// Between the particles there are rods in their order. What is out hangs from the first particle, the drum,
/// which is fixed. The first particles behind it may be on the drum: they move with it, and their rods do not
/// pull. The rod that leaves the drum is as long as what is out of it.
///
/// A particle leaves the drum where the rope does, with the rope's velocity, and comes back likewise. The
/// drum gives and takes its momentum and energy, and what is out goes on without a jump.
struct Reel {
  std::vector<std::uint32_t> particles{};  ///< Indices into Scene::particles: the drum, then the chain.
  double out = 0;  ///< Length that is out at the start, in m; 0 means that of the whole chain.
};

/// This is a rigid solid with a full tensor of inertia, carried by four particles that do not lie in one
/// plane. Its mass may: that of a disc is flat.
///
/// Rods keep the four apart, and the scene lists them like all others (add_body()). There are six, less those
/// between two fixed particles. The body's mass acts on the four by the exact kinetic energy (body_mass()),
/// and adds to masses of their own.
struct Body {
  std::array<std::uint32_t, 4> particles{};  ///< Indices into Scene::particles.
  double mass = 0;                           ///< Mass, in kg.
  Vec3 center{};                             ///< Centre of mass, in m, as the scene stands.
  Inertia inertia{};  ///< About that centre, in kg m², in the axes of space, as the scene stands.
};

/// This is a ball joint: two places that coincide and need not be at a shared particle. One that joins a
/// place to itself by other weights, such as a corner of a body to the particle there, does nothing.
struct Pin {
  Point a{};  ///< A place on one side.
  Point b{};  ///< The place on the other side.
};

/// Leads from one place to another. Both belong to one body if its angle with another is meant. They belong
/// to two bodies if their distance along another direction is meant.
struct Direction {
  Point from{};  ///< Where it starts.
  Point to{};    ///< Where it ends.
};

/// Keeps the dot product of two directions, such as a right angle or a place in a plane. One of the two may
/// have length zero, such as that from a place in the plane to another.
struct Alignment {
  Direction u{};                  ///< One direction.
  Direction v{};                  ///< The other.
  std::optional<double> value{};  ///< The product, in m². None: that of the scene as it stands.
};

/// Says what acts on the angle between two directions: limits, dry friction, and a drive towards a pose.
///
/// The angle is in (0, pi). Right angles are measured best. Near 0 and pi an angle has no derivative and is
/// measured badly. A direction between two bodies may change its length, which the angle does not feel.
struct AngleControl {
  Direction u{};                         ///< One direction.
  Direction v{};                         ///< The other.
  double lower = 0;                      ///< Least angle, in rad.
  double upper = std::numbers::pi;       ///< Largest angle, in rad.
  double friction = 0;                   ///< Largest torque that dry friction holds against, in N m.
  double target = std::numbers::pi / 2;  ///< Angle that the drive seeks, in rad.
  double stiffness = 0;                  ///< Stiffness of the drive, in N m/rad; 0 means no drive.
  double damping = 0;                    ///< Damping of the drive, in N m s/rad.
};

/// Pulls two places together with stiffness (l - length) + damping dl/dt + force, in N, at their distance l.
/// Between two particles an elastic Rod does the same.
///
/// A spring of length 0 pulls as three, along the axes of space, so that its ends may pass through each
/// other. It damps all that its ends move against each other.
struct Spring {
  Point a{};               ///< One end.
  Point b{};               ///< The other end.
  double length = 0;       ///< Length at rest, in m.
  double stiffness = 0;    ///< Stiffness, in N/m.
  double damping = 0;      ///< Damping, in N s/m.
  double force = 0;        ///< Pull that is added, in N, as of a motor.
  bool one_sided = false;  ///< Whether it is slack below its length, its force included, and never pushes.
};

/// Turns two sides against each other about an axis, with the torque stiffness (angle - phi) - damping
/// dphi/dt + torque, in N m. phi is the angle from `u` to `v`, both projected across the axis, and counts
/// whole turns.
struct Torsion {
  Direction axis{};      ///< The axis, which moves with the side of u. Its length does not matter.
  Direction u{};         ///< A direction of one side, which does not lie along the axis.
  Direction v{};         ///< A direction of the other side. At the start it is within half a turn of u.
  double angle = 0;      ///< Angle that is sought, in rad; it may be many turns.
  double stiffness = 0;  ///< Stiffness, in N m/rad.
  double damping = 0;    ///< Damping, in N m s/rad.
  double torque = 0;     ///< Torque on v's side that is added, in N m, as of a motor.
};

/// This is a shape: all that is within `radius` of the line between two places. It is a sphere if they are
/// the same; sphere_at() makes one. What has no shape touches nothing, ground neither. If all its particles
/// are fixed, it is ground that goes where they are moved. Friction turns it if both places are on one body
/// or along one rod. A sphere on one particle does not turn.
struct Capsule {
  Point a{};          ///< One end of the line.
  Point b{};          ///< The other end.
  double radius = 0;  ///< Radius, in m.
  Surface surface{};  ///< How it feels.
  Filter filter{};    ///< What it may touch.
};

/// This is a shape on a body: all that is within `radius` of the convex hull of points.
struct Hull {
  std::uint32_t body = 0;      ///< Index into Scene::bodies.
  std::vector<Vec3> points{};  ///< Points, in m, as the scene stands, which do not lie in one plane.
  double radius = 0;           ///< Radius of its edges and corners, in m.
  Surface surface{};           ///< How it feels.
  Filter filter{};             ///< What it may touch; its own island it never does.
};

/// Says how a rod's mass acts on its two ends.
///
/// `lumped` puts point masses there, with the right centre of mass but the inertia of a dumbbell (the
/// thesis). `consistent` takes the exact kinetic energy of a straight thin rod.
enum class MassModel : std::uint8_t { lumped, consistent };

/// Holds what a user describes, in double precision and in the user's own order.
struct Scene {
  std::vector<Particle> particles;  ///< Particles; rods and points name them by index.
  std::vector<Rod> rods;            ///< Rods between them.
  Vec3 gravity{0, -9.81, 0};        ///< Acceleration, in m/s².
  double drag = 0;                  ///< Rate in 1/s; velocities decay as exp(-drag · t).
  /// An island that is free loses all motion but that of a rigid whole at this rate, in 1/s. It acts as
  /// friction in all joints alike, and keeps momentum and angular momentum. One with fixed particles loses
  /// all motion against the world, as a pendulum's. Without it, nothing brakes joints, and a figure that goes
  /// on swinging does not sleep.
  double joint_drag = 0;

  std::vector<Bend> bends{};            ///< Bending stiffness between rods.
  std::vector<Twist> twists{};          ///< Torsional stiffness along chains.
  std::vector<Tackle> tackles{};        ///< Cords over pulleys.
  std::vector<Reel> reels{};            ///< Drums of ropes.
  std::vector<Body> bodies{};           ///< Rigid solids.
  std::vector<Pin> pins{};              ///< Ball joints.
  std::vector<Alignment> alignments{};  ///< Dot products that are kept.
  std::vector<AngleControl> angles{};   ///< Limits, friction and drives of angles.
  std::vector<Spring> springs{};        ///< Springs, dampers and motors between places.
  std::vector<Torsion> torsions{};      ///< Springs, dampers and motors about axes.
  std::vector<Capsule> capsules{};      ///< Shapes that move with the islands.
  std::vector<Hull> hulls{};            ///< Shapes that move with bodies.
  std::vector<Plane> planes{};          ///< Ground.
  std::vector<Box> boxes{};             ///< Solid boxes of the ground.
  std::vector<Pose> platforms{};        ///< Poses of what carries ground; see World::move_platform().

  std::vector<GroundCapsule> ground_capsules{};  ///< Solid capsules that do not move.
  std::vector<GroundHull> ground_hulls{};        ///< Convex solids that do not move.
  std::vector<GroundMesh> meshes{};              ///< Surfaces of triangles that do not move.
  std::vector<HeightField> height_fields{};      ///< Landscapes.
};

/// Returns whether a scene has more than particles and rods: bends, twists, tackles, reels, shapes, ground,
/// bodies, joints, springs, air on rods or sleepers.
PLUMB_API bool has_more_than_rods(const Scene& scene);

/// Refuses a scene that cannot be simulated. Throws InputError with the number of the particle, rod, bend,
/// twist, tackle, reel, body, joint, spring, torsion or shape, and the reason.
///
/// Of particles and rods it refuses:
/// - numbers that are not finite, negative mass or drag, a movable particle without mass;
/// - an unknown particle, a rod from a particle to itself, a duplicate rod, a rod with both ends fixed;
/// - zero or negative length, drag of a rod without mass;
/// - negative stiffness or damping, strength that is not positive;
/// - a damped rod that is not elastic, an elastic rod that neither stretches nor damps.
///
/// Of bends it refuses:
/// - an unknown particle, the same particle twice, three fixed particles, a second bend of the same three;
/// - rods that are not there, unless both of their ends are fixed in different places;
/// - negative stiffness or damping, or neither; an angle outside [0, 2.89].
///
/// Of twists it refuses:
/// - fewer than three particles, an unknown one, the same one twice unless a ring ends there, all fixed;
/// - rods that are not there, unless both of their ends are fixed in different places;
/// - stiffness that is not positive, an angle that is not finite.
///
/// Of tackles it refuses:
/// - fewer than two particles, an unknown one, neighbours that are the same, fixed particles alone;
/// - a length that is not positive and finite, laws that it refuses of rods, and a strength;
/// - friction that is negative or not finite.
///
/// Of reels it refuses:
/// - fewer than two particles, an unknown one, the same one twice, a drum that is not fixed, another that is;
/// - rods that are not there, or that have mass or a strength;
/// - anything else that holds a particle that may be wound;
/// - a length out that is negative, not finite, or more than the chain has.
///
/// Of bodies, joints and shapes it refuses:
/// - a body whose particles lie in one plane (their volume is below 1e-9 of their size cubed) or lack a rod;
/// - inertia that no solid has, or that of a line, which spins about itself without inertia;
/// - a rod between a flat or thin body's particles that is not rigid;
/// - weights of a point that do not add up to 1;
/// - a ball joint of one point, or one or an alignment of nothing that moves;
/// - an alignment's value that is not finite, or that rigid rods contradict;
/// - an angle without directions, or with limits outside [0, pi];
/// - a ball joint of places that rigid rods keep apart, and limits that an angle they keep is beyond;
/// - a spring or torsion of nothing that moves, a torsion without directions, or with one along its axis;
/// - negative stiffness or damping of these, or a force, torque, length or angle that is not finite;
/// - negative radius, size, friction or resistance, and restitution outside [0, 1];
/// - a platform that is not there, a belt or a pose that is not finite;
/// - a normal or a quaternion that is not of length one, to within 1e-9;
/// - a hull of an unknown body, or of points in one plane (flatter than 1e-6 of their size);
/// - a mesh with an unknown vertex, a triangle without area, or an edge with three triangles;
/// - a solid mesh with an edge without a second triangle, or that is turned inside out;
/// - a height field without cells, with cells without size, or with an unfinished row.
PLUMB_API void validate(const Scene& scene);

/// Returns the length of rod `i` in m. If none is given, that is the distance between its particles.
PLUMB_API double rod_length(const Scene& scene, std::size_t i);
/// Returns the length of tackle `i` in m. If none is given, that is the way through its particles.
PLUMB_API double tackle_length(const Scene& scene, std::size_t i);

/// Holds the mass matrix of a rod on its ends, in kg. Its kinetic energy is aa/2 va·va + ab va·vb + bb/2
/// vb·vb.
struct RodMass {
  double aa = 0;  ///< Of the first end.
  double ab = 0;  ///< Between the ends.
  double bb = 0;  ///< Of the second end.
};
/// Returns the mass matrix of rod `i` on its ends.
///
/// Let s be the fraction of the way from a to b. The consistent entries are the integrals of (1-s)², s(1-s)
/// and s² over the rod's mass. An evenly spread mass gives mass/6 [[2, 1], [1, 2]]. If lumped, ab is 0.
PLUMB_API RodMass rod_mass(const Scene& scene, std::size_t i, MassModel model);

/// Returns the 4 x 4 mass matrix of body `i` on its four particles, in kg.
///
/// With M_jk its entries, the kinetic energy is half the sum of M_jk v_j·v_k over all j and k, exactly that
/// of the solid. A place x that moves with the body has barycentric weights w_j(x) = a_j + b_j·(x - center).
/// M_jk integrates w_j w_k over the mass: mass a_j a_k + b_jᵀ S b_k. S = tr(inertia)/2 1 - inertia holds the
/// second moments about the centre, in kg m². validate() says which particles a body may have.
PLUMB_API std::array<std::array<double, 4>, 4> body_mass(const Scene& scene, std::size_t i);

/// Returns the mass of every particle in kg, with its share of the lumped mass of its rods and a quarter of
/// its bodies'. Anchors get infinity.
PLUMB_API std::vector<double> lumped_masses(const Scene& scene);

/// Returns the diagonal of the axis-aligned box around all particles, in m. Errors are relative to it.
PLUMB_API double bounding_diagonal(const Scene& scene);

}  // namespace plumb
