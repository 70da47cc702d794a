#pragma once

#include <algorithm>
#include <array>
#include <cstdint>
#include <optional>
#include <span>

#include "contact/colored_rods.hpp"
#include "contact/elastics/bend_elastics.hpp"
#include "contact/elastics/elastic.hpp"
#include "contact/pulls/linkage_pulls.hpp"
#include "contact/shapes/body_shape.hpp"
#include "contact/shapes/hulls/convex.hpp"
#include "contact/shapes/neighbors.hpp"
#include "linear/sparse_kkt.hpp"
#include "math/elementary.hpp"
#include "plumb/layouts/memory.hpp"
#include "plumb/scene.hpp"
#include "reference/multipliers/small_matrices.hpp"

namespace plumb::detail {

/// What all islands of one make have in common: bodies and rods that are held together, their masses, shapes
/// and joints, and the plan of the factors of
///   [M Jᵀ; J 0]
/// with M the exact mass matrix of rods and bodies and J the gradients of all constraints. Constraints are
/// without dimension: rods (|d|²/L² - 1)/2, alignments (u·v - c)/(|u| |v|); but for pins, in m.
class Linkage {
 public:
  struct Shape {
    Terms a, b;
    double radius;
    Surface surface;
    Filter filter{};
    /// Says what the shape turns with: nothing, the line from one place to another, or a body.
    enum class Turning : std::uint8_t { none, line, body };
    Turning turning = Turning::none;
    std::array<std::uint32_t, 4> turners{};  ///< the particles of that body, or the two of that line
    /// Returns the way along that line, from its first to its second particle.
    Combination line() const {
      if (turning != Turning::line) return {};
      return {.terms = {{{turners[1], 1}, {turners[0], -1}}}, .count = 2};
    }
  };
  /// This is a hull on the four particles of a body. As a shape it has no line, and friction acts on it where
  /// its core is touched.
  struct HullShape : Shape {
    using Vectors = std::array<Vec3, 4>;  ///< of its particles
    std::array<std::uint32_t, 4> particles{};
    Array<std::array<double, 4>> corners{};  ///< weights of its particles
    ConvexParts parts{};
    std::uint32_t number = 0;  ///< among shapes, where hulls follow capsules
    double half_width = 0;     ///< m, of its least width

    /// Picks its particles' vectors.
    Vectors of(std::span<const Vec3> vectors) const {
      return {vectors[particles[0]], vectors[particles[1]], vectors[particles[2]], vectors[particles[3]]};
    }
    /// Computes corners, or their motion, from those of its particles.
    void find_corners(const Vectors& from, std::span<Vec3> out) const;
    /// Returns the sum that a place is, with its particles in given places.
    Combination at(const Vectors& from, Vec3 place) const { return sum(weights(from, place)); }
    static std::array<double, 4> weights(const Vectors& from, Vec3 place);
    /// Returns the sum of its particles with given weights.
    Combination sum(const std::array<double, 4>& weights) const;
  };
  /// This is the end of a shape or a corner, which is what flat ground touches. Where several shapes end at
  /// one particle, the largest end counts.
  struct Ball {
    Terms center;
    double radius;
    Surface surface;
    std::uint32_t shape;  ///< to which what touches the ball counts
    Filter filter{};
  };
  struct Angle {
    Combination u, v;
  };
  /// What else acts on an angle changes while a world runs.
  struct AngleRule {
    double lower, upper, friction;
  };
  /// Says how an angle changes with the particles of its two directions: rate = along_u·u' + along_v·v'.
  struct AngleSlope {
    double value;           ///< rad
    Vec3 along_u, along_v;  ///< 1/m
  };
  static AngleSlope slope(const Angle& angle, std::span<const Vec3> x) {
    return slope(angle.u.of(x), angle.v.of(x));
  }
  static AngleSlope slope(Vec3 u, Vec3 v);

  /// Says what will move islands of a kind. Those that are relaxed need no matrix.
  enum class Use : std::uint8_t { solved, relaxed };
  /// `part` is one island of `scene`, with its particles' numbers; the movable ones first. `grabs` are places
  /// less fixed particles, their targets. They have the last elastics, three each.
  Linkage(const Scene& part, Isa isa, Use use = Use::solved, std::span<const Combination> grabs = {});

  std::uint32_t particles() const { return particles_; }
  std::uint32_t movable() const { return movable_; }
  /// Returns the mass of a movable particle with its share of rods and bodies, kg.
  double mass_of(std::uint32_t particle) const { return weights_[particle]; }
  /// Returns whether relaxation can move it, and does so well: it has particles, rods and joints alone.
  /// Cables and single particles it moves well in a crowd.
  bool can_relax() const { return colored_.colors() > 0 || rods_.empty(); }
  bool relaxes_well(bool in_crowd) const { return in_crowd ? crowds_ : relaxes_; }
  const ColoredRods& colored() const { return colored_; }
  /// Calls visit(apart) for every ball joint, with the sum that is to be nothing.
  template <class Visit>
  void for_pins(Visit&& visit) const {
    for (const PinRow& pin : pins_) visit(pin.sum);
  }
  /// Calls visit(u, v, value) for every alignment, whose dot product (m²) keeps its value.
  template <class Visit>
  void for_alignments(Visit&& visit) const {
    for (const DotRow& each : dots_) visit(each.u, each.v, each.value);
  }
  std::uint32_t rods() const { return static_cast<std::uint32_t>(rods_.size() + giving_rods_.size()); }
  std::uint32_t constraints() const { return constraints_; }
  bool has_loops() const { return rods() > particles_; }  ///< of rods, as bodies and nets have
  bool is_net() const { return has_loops() && bodies_.empty(); }
  /// Numbers of particles from `first` up to `end`: all, the movable and the fixed ones.
  struct Range {
    std::uint32_t first, end;
  };
  Range all() const { return {0, particles_}; }
  Range movable_ones() const { return {0, movable_}; }
  Range fixed_ones() const { return {movable_, particles_}; }
  const KktPlan& plan() const { return plan_; }
  std::span<const Shape> shapes() const { return shapes_; }
  std::span<const HullShape> hulls() const { return hulls_; }
  std::span<const BodyShape> bodies() const { return bodies_; }
  const Shape& shape_of(std::uint32_t number) const {  ///< or a hull
    return number < shapes_.size() ? shapes_[number] : hulls_[number - shapes_.size()];
  }
  const Neighbors& neighbors() const { return neighbors_; }  ///< which shapes may touch each other
  /// Balls of hulls come after those of capsules. Whatever has shapes has balls.
  std::span<const Ball> balls() const { return balls_; }
  bool has_shapes() const { return !balls_.empty(); }
  /// Returns the filters of all shapes, each once.
  std::span<const Filter> filters() const { return filters_; }
  std::span<const Angle> angles() const { return angles_; }
  std::span<const AngleRule> angle_rules() const { return angle_rules_; }  ///< as the scene says
  /// Elastics are of rods that give, angles with drives or dampers, springs, torsions and bends, in order.
  std::span<const Elastic> elastics() const { return elastics_; }
  std::span<const ElasticLaw> elastic_laws() const { return elastic_laws_; }  ///< as the scene says
  /// Says which elastics a spring, a torsion or an angle is, by its number in the part. An angle may be none.
  struct ElasticRange {
    std::uint32_t first = 0, count = 0;
  };
  ElasticRange elastics_of_angle(std::uint32_t i) const { return of_angles_[i]; }
  ElasticRange elastics_of_spring(std::uint32_t i) const { return of_springs_[i]; }
  ElasticRange elastics_of_torsion(std::uint32_t i) const { return of_torsions_[i]; }
  std::span<const BendElastics> bends() const { return bends_; }
  bool is_of_bend(std::size_t elastic) const;
  std::size_t first_grab() const { return first_grab_; }  ///< the first of the elastics that grabs are
  bool breaks() const { return breaks_; }                 ///< Some rod may.
  /// Returns how many rods give, the first elastics, and which of them the part's rod `number` is, or none.
  std::size_t giving_rods() const { return giving_rods_.size(); }
  std::optional<std::size_t> elastic_of_rod(std::uint32_t number) const;
  std::uint32_t row_of_rod(std::uint32_t number) const;  ///< that of its constraint; it must be rigid
  /// Returns the number of an elastic, in m or rad. Of all turns it is the one nearest to `near`.
  double number(const Elastic& elastic, std::span<const Vec3> x, double near) const;
  /// Returns how that changes with the elastic's sums; nothing where it has no derivative.
  ElasticSlope slope(const Elastic& elastic, std::span<const Vec3> x) const;
  /// Pushes movable particles by `by` (N) along an elastic's gradient.
  void push_along(const Elastic& elastic, const ElasticSlope& slope, double by, std::span<Vec3> out) const;
  /// Returns how fast those particles at `v` (m/s) change an elastic's number.
  static double rate(const Elastic& elastic, const ElasticSlope& slope, std::span<const Vec3> v, Range of);
  /// Writes an elastic's gradient and its `soft` (1/kg) into a matrix, where it is decoupled else.
  void couple(const Elastic& elastic, const ElasticSlope& slope, double soft,
              std::span<simd::Block> matrix) const;

  /// Makes pulls that count, of an island of this kind.
  LinkagePulls make_pulls() const;
  /// Adds the multipliers of a solution, times `by`, to those of constraints and elastics in `out`.
  void take_multipliers(std::span<const double> solved, double by, std::span<double> out) const;
  /// Adds to `pulls` what multipliers of constraints at `x` pull with; times `by` they are impulses.
  void count_pulls(std::span<const Vec3> x, std::span<const double> squares,
                   std::span<const double> multipliers, double by, LinkagePulls& pulls) const;
  /// Adds the impulse (N s or N m s) with which an elastic pulls at `x`.
  void count_pull(std::size_t elastic, std::span<const Vec3> x, double pull, LinkagePulls& pulls) const;
  /// Adds the share of a push on a place that its fixed particles get.
  void push_fixed(Terms at, Vec3 impulse, LinkagePulls& pulls) const;
  std::uint32_t anchors() const { return particles_ - movable_ - targets_; }  ///< no targets of grabs
  bool is_grounded() const { return anchors() > 0; }
  /// Returns whether constraints forbid some motion more than once, as the kind was made or at x.
  bool is_redundant() const { return is_redundant_; }
  bool is_redundant_at(std::span<const Vec3> x) const;
  double softness() const { return softness_; }  ///< 1/kg, by which the matrix lets constraints give
  /// Returns whether anything but contact takes energy: air, drag or joint drag.
  bool has_air() const { return has_air_; }
  double size() const { return size_; }  ///< largest rod or shape in m, to which errors are relative
  /// Returns the least radius of a shape, m, or a hundredth of the size if that is more.
  double thinness() const;
  double mass() const { return mass_; }  ///< mass of the movable particles, kg
  double drag() const { return drag_; }  ///< 1/s
  /// Returns the share of a velocity that drag leaves after a time t (s).
  double kept(double t) const { return drag_ == 0 ? 1 : detail::exp(-t * drag_); }
  double joint_drag() const { return joint_drag_; }  ///< 1/s
  Vec3 gravity() const { return gravity_; }
  void set_gravity(Vec3 gravity) { gravity_ = gravity; }
  /// Returns where a movable particle's x stands in vectors that are solved; y and z follow.
  std::uint32_t slot(std::uint32_t particle) const { return slots_[particle]; }
  /// Writes the vectors of all movable particles into their slots. taken() reads one from its slot.
  void put(std::span<const Vec3> vectors, std::span<double> solved) const;
  Vec3 taken(std::span<const double> solved, std::uint32_t particle) const {
    const double* const at = &solved[slots_[particle]];
    return {at[0], at[1], at[2]};
  }

  /// Adds a vector to the particles of a place, each by its weight.
  void add(Terms at, Vec3 vector, std::span<double> solved) const;
  /// Returns the part of a place's motion that is that of fixed particles.
  Vec3 of_fixed(Terms at, std::span<const Vec3> motion) const;
  /// Returns what a movable particle has on the diagonal of M, kg, or a quarter of a flat body if it is more.
  double own_mass_of(std::uint32_t particle) const { return nominal_masses_[particle]; }
  /// Returns a mass (kg) that a movable particle has at least, whatever the others do, and none of bodies: M
  /// less these on its diagonal has no negative eigenvalue. It is what couplings leave of its row.
  double free_mass_of(std::uint32_t particle) const { return free_masses_[particle]; }
  bool has_free_masses() const { return has_free_masses_; }
  bool is_held(std::uint32_t particle) const { return is_held_[particle] != 0; }  ///< by constraints
  /// Returns the mass of a place's heaviest movable particle, kg.
  double heaviest(Terms at) const;

  /// Adds what holds a place to M: the products of its particles' weights, each times `by`.
  void stiffen(Terms at, const Sym3& by, std::span<simd::Block> matrix) const;
  /// A taut rod is one whose ends may swing across it, since no body holds both. The matrix couples them.
  std::size_t taut_rods() const { return taut_rods_.size(); }
  /// Finds how stiff rods are across themselves, kg: what multipliers of a substep turn by as rods turn.
  void find_tautness(std::span<const double> multipliers, std::span<double> out) const;
  /// Finds the inertia (kg) across taut rods with which a substep of h (s) can follow waves along them, from
  /// how stiff they were (kg/s²) in the last two substeps.
  void find_wave_inertia(std::span<const double> stiffness, std::span<const double> before, double h,
                         std::span<double> out) const;
  void gather_wave_inertia(std::span<const double> inertia, std::span<double> of_particles) const;
  /// Adds that inertia to M, and to momenta of motions `v` if no more than `most`, and to twice their energy.
  void add_wave_inertia(std::span<const double> inertia, std::span<simd::Block> matrix) const;
  void add_wave_momenta(std::span<const double> inertia, std::span<const double> most,
                        std::span<const Vec3> v, std::span<Vec3> out) const;
  /// Adds what that inertia of rods to anchors pushes these with as velocities change.
  void count_wave_pulls(std::span<const double> inertia, std::span<const double> most,
                        std::span<const Vec3> before, std::span<const Vec3> after, LinkagePulls& pulls) const;
  double wave_product(std::span<const double> inertia, std::span<const Vec3> v) const;
  /// Counts rods of flat bodies. These have a singular M, which gets rho Jᵀ J of their rods: see push_flat().
  std::size_t flat_rods() const { return flat_rods_.size(); }
  /// Finds the gradients of such rods at `x`, along their second ends, in 1/m.
  void find_flat_gradients(std::span<const Vec3> x, std::span<Vec3> out) const;
  /// Adds rho Jᵀ c to the right hand side, of such rods and their right hand sides c: M alone then counts.
  void push_flat(std::span<const Vec3> gradients, std::span<double> right) const;
  /// Evaluates M and J at `x`, for KktPlan::factor().
  void assemble(std::span<const Vec3> x, Array<simd::Block>& matrix) const;
  /// Writes the constraints at `x`, times -1, into their places of `right`. Returns the largest absolute one,
  /// as a share of those of `squares` that are above 1, which all call RodLengths::squares() by.
  double violations(std::span<const Vec3> x, std::span<const double> squares, std::span<double> right) const;
  /// Writes J(x) d - C(x + d). A solution for it moves by about d and keeps constraints to second order.
  void targets(std::span<const Vec3> x, std::span<const Vec3> d, std::span<const Vec3> there,
               std::span<const double> squares, std::span<double> right) const;
  /// Adds what multipliers of constraints at `x` pull with to momenta of movable particles, -J(x)ᵀ of them,
  /// but for those of pins. It is linear in `x`, so that ways between configurations tell how pulls turn.
  void add_pulls(std::span<const Vec3> x, std::span<const double> multipliers, std::span<Vec3> out) const;
  /// Returns by how much momenta (kg m) would move a movable particle at most, if it were alone (m).
  double largest_move(std::span<const Vec3> momenta) const;
  /// Writes -J v of some particles into the places of `right`. That of the fixed ones is what constraints
  /// must do about anchors that move. Elastics get 0.
  void rates(std::span<const Vec3> x, std::span<const Vec3> v, Range of, std::span<double> right) const;
  /// Writes how constraints bend away from a motion that goes straight on: minus their second derivatives.
  void bends(std::span<const Vec3> v, std::span<double> right) const;
  /// out = M v, of movable particles.
  void momenta(std::span<const Vec3> v, std::span<Vec3> out) const;
  /// Computes gravity, constant forces and air at `x` and `v`, in N.
  void forces(std::span<const Vec3> x, std::span<const Vec3> v, std::span<const Vec3> constant,
              std::span<Vec3> out) const;
  double kinetic(std::span<const Vec3> v) const;  ///< J, of movable particles
  double potential(std::span<const Vec3> x, std::span<const Vec3> constant) const;
  /// Returns the fastest turn of a rod, in 1/s. Of rods that give, those with a number in `broken` are out.
  double turning(std::span<const Vec3> v, std::span<const double> squares,
                 std::span<const std::uint8_t> broken) const;
  /// Splits velocities into those of a rigid body, which go to `rigid`, and the rest. Returns the kinetic
  /// energy of the rest, in J. The linkage must have no fixed particles.
  double split(std::span<const Vec3> x, std::span<const Vec3> v, std::span<Vec3> rigid) const;
  /// Lets drag of joints act for `h` (s) on velocities at `x`. Overwrites `rigid`.
  void brake_joints(double h, std::span<const Vec3> x, std::span<Vec3> v, Array<Vec3>& rigid) const;
  /// The angular momentum about the centre of mass, kg m²/s, of linkages without fixed particles.
  Vec3 angular_momentum(std::span<const Vec3> x, std::span<const Vec3> v) const;
  /// Turns a linkage without fixed particles as a whole, until that is its angular momentum.
  void turn_to(Vec3 angular, std::span<const Vec3> x, std::span<Vec3> v) const;

 private:
  struct RodRow {
    std::uint32_t a, b;
    double over2;  ///< 1/L²
    std::uint32_t number, row;
    std::array<std::uint32_t, 6> places;  ///< of J among the values, ends a and b; none if fixed
  };
  struct TautRod {
    std::uint32_t a, b, row;
    double turns;                           ///< by this its multiplier is how stiff it is across itself
    double over_mass = 0;                   ///< 1/kg, the sum of its ends' inverse masses
    std::array<std::uint32_t, 9> places{};  ///< of M: x, y and z of a, of b, and between them; or none
  };
  struct FlatRod {
    std::uint32_t a, b, row;
    double over2, mass;  ///< 1/L², and kg, that of the body
    Combination way() const { return {.terms = {{{b, 1}, {a, -1}}}, .count = 2}; }
  };
  struct DotRow {
    Combination u, v;
    double value, over;
    std::uint32_t row;
    Array<std::uint32_t> places, touched;  ///< the first three by particle, in the order of the second
  };
  struct PinRow {
    Combination sum;
    std::array<std::uint32_t, 3> rows;
    Array<std::uint32_t> places;  ///< by term: x, y and z
  };
  struct Coupling {
    std::uint32_t a, b;  ///< a < b
    double mass;
    std::uint32_t place = 0;  ///< of x in the matrix
  };
  struct Air {
    std::uint32_t a, b;
    RodMass mass;
    double linear, orthogonal, over;  ///< 1/m
  };
  static constexpr std::uint32_t none = 0xffffffff;

  /// Lists the movable particles of some sums, each once.
  Array<std::uint32_t> movable_of(std::span<const Combination> sums) const;
  /// Adds a gradient along one of the sums to the places of the particles in `touched`.
  static void add_gradient(const Combination& sum, Vec3 along, std::span<const std::uint32_t> touched,
                           std::span<const std::uint32_t> places, std::span<double> values);

  struct Whole;
  Whole whole(std::span<const Vec3> x, std::span<const Vec3> v) const;

  /// Rods, then alignments and pins take their rows in this order; `row` is the next one.
  void add_rods(const Scene& part, std::uint32_t& row);
  void add_joints(const Scene& part, std::span<const Vec3> x, std::uint32_t& row);
  void add_angles(const Scene& part);
  void add_filter(const Filter& filter);
  void add_shapes(const Scene& part, std::span<const Vec3> x);
  void add_hulls(const Scene& part, std::span<const Vec3> x);
  void weigh(const Scene& part, Use use);
  void weigh_flat_bodies(const Scene& part, Use use);
  void find_flat_rods(const Scene& part);
  void stiffen_flat(std::span<const Vec3> x, std::span<simd::Block> matrix) const;
  /// Elastics take their rows after all constraints.
  void add_elastics(const Scene& part);
  void add_elastic(Elastic elastic, const ElasticLaw& law);
  void add_bends(const Scene& part);
  void couple_shapes(Array<std::pair<std::uint32_t, std::uint32_t>>& pairs) const;
  bool is_rigid_rod(std::size_t elastic) const;
  void color_rods(), plan(Isa isa), place_constraints(), find_loose();
  void find_taut_rods(const Scene& part);
  /// Gives constraints in a matrix a share of what J M⁻¹ Jᵀ has on its diagonal, which it returns.
  Array<double> soften(double share, std::span<double> values) const;
  void hold_constraints(std::span<const Vec3> x);

  std::uint32_t particles_ = 0, movable_ = 0, constraints_ = 0;
  KktPlan plan_;
  Array<std::uint32_t> slots_;
  Array<double> softs_;  ///< -1 times what constraints have on the diagonal
  Array<RodRow> rods_, giving_rods_;
  Array<DotRow> dots_;
  Array<PinRow> pins_;
  Array<double> masses_;          ///< kg, the diagonal of M
  Array<double> nominal_masses_;  ///< kg, the same, or more where a body is flat
  Array<double> free_masses_;     ///< kg, see free_mass_of()
  Array<Coupling> couplings_;     ///< off the diagonal, between movable particles
  Array<std::uint8_t> is_held_;   ///< by particle
  Array<double> weights_;         ///< kg, what gravity pulls on
  Array<Air> airs_;
  TermPool places_;  ///< on shapes
  Array<Shape> shapes_;
  Array<HullShape> hulls_;
  Array<BodyShape> bodies_;
  Neighbors neighbors_;
  Array<Ball> balls_;
  Array<Filter> filters_;
  Array<Angle> angles_;
  Array<AngleRule> angle_rules_;
  Array<Elastic> elastics_;
  Array<ElasticLaw> elastic_laws_;
  Array<ElasticRange> of_angles_, of_springs_, of_torsions_;
  Array<BendElastics> bends_;
  Array<TautRod> taut_rods_;
  Array<FlatRod> flat_rods_;
  ColoredRods colored_;
  Vec3 gravity_{};
  std::size_t first_grab_ = 0, targets_ = 0;
  double drag_ = 0, joint_drag_ = 0, size_ = 0, mass_ = 0, softness_ = 0;
  bool has_air_ = false, has_free_masses_ = false, is_redundant_ = false, breaks_ = false;
  bool relaxes_ = false, crowds_ = false;
};

}  // namespace plumb::detail
