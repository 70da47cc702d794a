#pragma once

#include <cstdint>
#include <stdexcept>
#include <vector>

#include "plumb/scene.hpp"
#include "truth/real.hpp"

/// What a scene means, in long double: the constrained equations of motion
///
///   M a = M g - drag M v + J^T mu,   (|x_b - x_a|^2 - length^2) / 2 = 0 for every rod,
///
/// with J the gradients of the rods: x_b - x_a at b, its opposite at a. mu, in N/m, is a rod's push divided
/// by its length.
namespace plumb::truth {

/// No truth to the accuracy asked for: the message says what was reached, or what cannot be solved.
class Unreachable : public std::runtime_error {
  using std::runtime_error::runtime_error;
};

struct ModelRod {
  std::uint32_t a = 0, b = 0;
  Real length = 0;    ///< m
  Real at_b = 0;      ///< kg, of the rod's own mass on the diagonal of the mass matrix at b
  Real coupling = 0;  ///< kg, the mass matrix's element between its ends; 0 if lumped
};

/// Per particle, in the scene's order. Gravity acts on all of the mass that moves with a particle, also on
/// the part that a consistent mass matrix couples to the other end of a rod, whether or not that is fixed.
struct Model {
  std::vector<char> fixed;
  std::vector<Real> mass;    ///< kg, on the mass matrix's diagonal
  std::vector<Real> weight;  ///< kg, what gravity pulls at
  std::vector<ModelRod> rods;
  Point gravity;      ///< m/s^2
  Real drag = 0;      ///< 1/s
  Real diagonal = 1;  ///< m, of the scene's bounding box: what positions are relative to; 1 if it has none
  /// m/s, what velocities are relative to: the greater of sqrt(g diagonal) and the fastest start; 1 if
  /// neither is positive.
  Real speed = 1;

  std::size_t particles() const { return fixed.size(); }
};

struct State {
  std::vector<Point> x;  ///< m
  std::vector<Point> v;  ///< m/s
};

/// Throws InputError as validate() does.
Model make_model(const Scene& scene, MassModel mass);

/// The scene's start, fixed particles at rest. Throws InputError naming the rod if one is off its length by
/// more than `largest_start_stretch` of it: what truth there is belongs to rods that are kept.
State start_of(const Scene& scene, const Model& model);
inline constexpr double largest_start_stretch = 1e-10;

/// The stretch of the rod that has most, relative to its length.
struct WorstRod {
  Real stretch = 0;  ///< (|x_b - x_a| - length) / length, its absolute value
  std::size_t rod = 0;
};
WorstRod worst_stretch(const Model& model, const std::vector<Point>& x);

}  // namespace plumb::truth
