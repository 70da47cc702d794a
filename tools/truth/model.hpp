#pragma once

#include <cstdint>
#include <span>
#include <stdexcept>
#include <vector>

#include "plumb/scene.hpp"
#include "scenes/basics/length_rate.hpp"
#include "truth/real.hpp"

/// A scene stands for these constrained equations of motion, in long double:
///
///   M a = M g - drag M v + J^T mu,   (|x_b - x_a|^2 - L^2) / 2 = 0 for every rigid rod,
///
/// L = length + rate t is constant but for rods that a winch works on. J holds the gradients of the
/// rods, which are x_b - x_a at b and its opposite at a. mu, in N/m, is a rod's push divided by its length l
/// = |x_b - x_a|. An elastic rod is no constraint, because its push is known:
///
///   mu l = -stiffness (l - L) - damping dl/dt
///
/// Bends and twists act as Scene says. Their forces are derivatives of bending energy, and the torques of
/// twists times the derivatives of what they twist by.
namespace plumb::truth {

/// There is no truth to the accuracy asked for. The message says what was reached, or what cannot be solved.
class Unreachable : public std::runtime_error {
  using std::runtime_error::runtime_error;
};

struct ModelRod {
  std::uint32_t a = 0, b = 0;
  Real length = 0;       ///< Length at the start, in m; of an elastic rod that at which it does not pull.
  Real rate = 0;         ///< Rate at which that length changes, in m/s.
  Real at_b = 0;         ///< Part of the rod's own mass on the diagonal of the mass matrix at b, in kg.
  Real coupling = 0;     ///< The mass matrix's element between its ends, in kg; 0 if lumped.
  bool elastic = false;  ///< Whether it pulls as the next two say. Otherwise it keeps its length.
  Real stiffness = 0;    ///< Stiffness, in N/m.
  Real damping = 0;      ///< Damping along the rod, in N s/m.

  /// Returns its length at a time (s), in m.
  Real length_at(Real t) const { return length + rate * t; }
};

/// A bend has the energy stiffness/2 (kappa - rest)^2. With w = d1/L1 - d2/L2 and q = w.w the square of kappa
/// is q/(1 - q/4).
struct ModelBend {
  std::uint32_t a = 0, b = 0, c = 0;
  Real first = 0, second = 0;  ///< Lengths L1 and L2 from a to b and from b to c, in m.
  Real stiffness = 0;          ///< Stiffness, in N m.
  Real rest = 0;               ///< Curvature 2 tan(angle/2) at rest.
};
/// Where q is larger, plumb's bends go on along a tangent, which has no series.
inline constexpr Real most_fold = 4 - 1 / Real{16};

/// A twisted chain goes through these particles, over rods of these lengths.
struct ModelTwist {
  std::vector<std::uint32_t> particles;
  std::vector<Real> lengths;  ///< Lengths, in m, one fewer than particles.
  Real stiffness = 0;         ///< Torsional stiffness over length, in N m.
  Real angle = 0;             ///< Twist at the start, in rad.
};

/// Particles are in the scene's order. Gravity acts on all of the mass that moves with a particle. That
/// includes the part that a consistent mass matrix couples to the other end of a rod, fixed or not.
struct Model {
  std::vector<char> fixed;
  std::vector<Real> mass;    ///< Diagonal of the mass matrix, in kg.
  std::vector<Real> weight;  ///< Mass that gravity pulls at, in kg.
  std::vector<ModelRod> rods;
  std::vector<ModelBend> bends;
  std::vector<ModelTwist> twists;
  Point gravity;  ///< Gravity, in m/s².
  Real drag = 0;  ///< Drag, in 1/s.
  /// Diagonal of the scene's bounding box in m, to which positions are relative; 1 if it has none.
  Real diagonal = 1;
  /// Speed in m/s to which velocities are relative. It is the greatest of sqrt(g diagonal), the fastest
  /// start, and what all mass gets from the energy of elastic rods, bends and twists at the start. It is 1 if
  /// none is positive.
  Real speed = 1;

  std::size_t particles() const { return fixed.size(); }
};

struct State {
  std::vector<Point> x;         ///< Positions, in m.
  std::vector<Point> v;         ///< Velocities, in m/s.
  std::vector<Real> twisted{};  ///< How far chains are twisted, in rad.
};

/// Makes the model of a scene. Throws InputError as validate() does. It also refuses rods that are one-sided
/// or may break, because their pull is not smooth and has no series in time. Nor have damped bends, bends
/// with a rest angle that start straight, and twists of elastic rods. `rates` are of rods without inertia of
/// their own, in scenes without bends and twists.
Model make_model(const Scene& scene, MassModel mass, std::span<const scenes::LengthRate> rates = {});

/// Returns the scene's start, with fixed particles at rest. Throws InputError naming the rod if one is off
/// its length by more than `largest_start_stretch` of it. Truth is defined for rods that are kept. Elastic
/// rods may start at any length but 0, where their pull has no direction.
State start_of(const Scene& scene, const Model& model);
inline constexpr double largest_start_stretch = 1e-10;

/// This is the rigid rod with the largest strain at a time (s).
struct WorstRod {
  Real stretch = 0;  ///< Strain (|x_b - x_a| - length) / length, its absolute value.
  std::size_t rod = 0;
};
WorstRod worst_stretch(const Model& model, const std::vector<Point>& x, Real t = 0);

}  // namespace plumb::truth
