#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <vector>

#include "plumb/vec3.hpp"

namespace plumb {

/// A point with mass. A fixed particle never moves by itself (inverse mass 0) and its mass is ignored.
struct Particle {
  Vec3 position{};  ///< m
  Vec3 velocity{};  ///< m/s
  double mass = 0;  ///< kg; a movable particle needs mass of its own or from its rods
  bool fixed = false;
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
};

/// Refuses a scene that cannot be simulated; throws InputError naming the particle or rod and the reason:
/// non-finite numbers, negative mass or drag, a movable particle without mass, an unknown particle,
/// a rod from a particle to itself, zero or negative length, a duplicate rod, a rod with both ends fixed.
void validate(const Scene& scene);

/// The length of rod `i` in metres, with the default (distance between its particles) filled in.
double rod_length(const Scene& scene, std::size_t i);

/// The mass matrix of a rod on its ends, in kg: its kinetic energy is aa/2 va·va + ab va·vb + bb/2 vb·vb.
/// Consistent: with s the fraction of the way from a to b, aa, ab and bb are the integrals of (1-s)^2, s(1-s)
/// and s^2 over its mass; evenly spread, mass/6 [[2, 1], [1, 2]]. Lumped: ab is 0.
struct RodMass {
  double aa = 0;
  double ab = 0;
  double bb = 0;
};
RodMass rod_mass(const Scene& scene, std::size_t i, MassModel model);

/// Mass of every particle in kg with its share of the lumped mass of its rods. Fixed particles get infinity.
std::vector<double> lumped_masses(const Scene& scene);

/// Diagonal of the axis-aligned box around all particles, in metres: the length errors are relative to.
double bounding_diagonal(const Scene& scene);

}  // namespace plumb
