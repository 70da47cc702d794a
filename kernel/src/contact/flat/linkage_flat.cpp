// This file lets a linkage move bodies that are flat, such as a disc.
//
// Four particles move in twelve ways. A flat body has inertia in nine of them: none in those that stretch or
// shear its four particles off its plane. The rods between them forbid these, so that the motion is well
// defined, but M cannot be eliminated. With rho Jᵀ J of these rods on it, it can. Let c be what their rows
// have on the right hand side. Then
//   (M + rho Jᵀ J) d + Jᵀ y = f + rho Jᵀ c,  J d = c
// has the solution d and the multipliers y of M d + Jᵀ y = f, J d = c, whatever rho is. So nothing of the
// motion depends on rho (an augmented Lagrangian: Hestenes 1969; Golub and Greif 2003). It is the mass of the
// body, so that what it adds to M is like what M has.

#include <algorithm>

#include "contact/linkage/linkage.hpp"
#include "reference/multipliers/small_matrices.hpp"
#include "scene/flat/flat_bodies.hpp"

namespace plumb::detail {
namespace {

/// Relaxation gives every particle of a flat body at least this share of its mass, since it moves particles
/// by their inverse masses. A disc of add_body() then turns about its diameters slower by 0.3 %.
constexpr double relaxed_share = 1e-3;

}  // namespace

void Linkage::weigh_flat_bodies(const Scene& part, Use use) {
  for (std::size_t i = 0; i < part.bodies.size(); ++i) {
    if (!has_singular_mass(part, i)) continue;
    const Body& body = part.bodies[i];
    for (const std::uint32_t particle : body.particles) {
      if (particle >= movable_) continue;
      nominal_masses_[particle] = std::max(nominal_masses_[particle], nominal_mass(body));
      if (use != Use::relaxed) continue;
      masses_[particle] = std::max(masses_[particle], relaxed_share * body.mass);
      weights_[particle] = std::max(weights_[particle], relaxed_share * body.mass);
    }
  }
}

void Linkage::find_flat_rods(const Scene& part) {
  for (std::size_t i = 0; i < part.bodies.size(); ++i) {
    if (!has_singular_mass(part, i)) continue;
    const Body& body = part.bodies[i];
    const auto is_in = [&](std::uint32_t particle) {
      return std::find(body.particles.begin(), body.particles.end(), particle) != body.particles.end();
    };
    for (const RodRow& rod : rods_)
      if (is_in(rod.a) && is_in(rod.b)) flat_rods_.push_back({rod.a, rod.b, rod.row, rod.over2, body.mass});
  }
}

void Linkage::find_flat_gradients(std::span<const Vec3> x, std::span<Vec3> out) const {
  for (std::size_t i = 0; i < flat_rods_.size(); ++i)
    out[i] = flat_rods_[i].over2 * (x[flat_rods_[i].b] - x[flat_rods_[i].a]);
}

void Linkage::stiffen_flat(std::span<const Vec3> x, std::span<simd::Block> matrix) const {
  for (const FlatRod& rod : flat_rods_) {
    const Vec3 along = x[rod.b] - x[rod.a];
    stiffen(rod.way(), outer_both((0.5 * rod.mass * rod.over2) * along, along), matrix);
  }
}

void Linkage::push_flat(std::span<const Vec3> gradients, std::span<double> right) const {
  for (std::size_t i = 0; i < flat_rods_.size(); ++i) {
    const FlatRod& rod = flat_rods_[i];
    const double by = rod.mass / rod.over2 * right[plan_.position(rod.row)];
    add(rod.way(), by * gradients[i], right);
  }
}

}  // namespace plumb::detail
