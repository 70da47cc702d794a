// This file slows waves along taut rods that a substep does not resolve.
//
// Constraints keep to the gradients of a substep's start. A rod that is pulled with T swings across itself
// with the stiffness T/L, which then acts as an explicit force does: substeps above 2/omega of the fastest
// wave blow up. Such rods get an inertia of their own against turning. It is a multiple of what they are
// stiff with in the substep, so that they swing as slowly as the substep can follow. Rest, gravity, momentum
// and angular momentum are none of its business, and a load that swings on a rope feels it by the square of
// the substep. What is added to it starts at rest: it brings no energy, and takes a little of the rod's turn.

#include <algorithm>
#include <cmath>
#include <set>
#include <utility>

#include "contact/linkage/linkage.hpp"

namespace plumb::detail {
namespace {

/// Waves are slowed once a rod's stiffness in a substep is this share of what its ends bear. At one they blow
/// up.
constexpr double resolved = 0.5;
/// Rods get so many times what they are too stiff by. One would do in the air; on ground that is round,
/// rocking is about as stiff as waves are.
constexpr double slower = 2;

}  // namespace

void Linkage::find_taut_rods(const Scene& part) {
  Array<std::pair<std::uint32_t, std::uint32_t>> pairs;
  couple_shapes(pairs);
  std::set<std::pair<std::uint32_t, std::uint32_t>> coupled, in_bodies;
  for (const auto& [a, b] : pairs) coupled.insert(std::minmax(a / 3, b / 3));
  for (const Body& body : part.bodies)
    for (const std::uint32_t a : body.particles)
      for (const std::uint32_t b : body.particles) in_bodies.emplace(a, b);
  const auto add = [&](TautRod rod) {
    const bool both_move = rod.a < movable_ && rod.b < movable_;
    if (in_bodies.contains({rod.a, rod.b}) || (both_move && !coupled.contains(std::minmax(rod.a, rod.b))))
      return;
    TautRod& taut = taut_rods_.emplace_back(rod);
    taut.places.fill(none);
    for (std::uint32_t axis = 0; axis < 3; ++axis) {
      const auto place = [&](std::uint32_t i, std::uint32_t j) {
        return plan_.place(3 * i + axis, 3 * j + axis);
      };
      if (rod.a < movable_) taut.places[axis] = place(rod.a, rod.a);
      if (rod.b < movable_) taut.places[3 + axis] = place(rod.b, rod.b);
      if (both_move) taut.places[6 + axis] = place(rod.a, rod.b);
    }
    for (const std::uint32_t end : {rod.a, rod.b})
      if (end < movable_) taut.over_mass += 1 / weights_[end];
  };
  if (part.bodies.empty()) taut_rods_.reserve(rods_.size());
  for (const RodRow& rod : rods_) add({rod.a, rod.b, rod.row, rod.over2});
  for (std::size_t i = 0; i < elastics_.size(); ++i) {
    const Combination& apart = elastics_[i].sums[0];
    if (is_rigid_rod(i))
      add({apart.terms[0].particle, apart.terms[1].particle, elastics_[i].row, 1 / elastic_laws_[i].rest});
  }
}

void Linkage::find_tautness(std::span<const double> multipliers, std::span<double> out) const {
  for (std::size_t i = 0; i < taut_rods_.size(); ++i)
    out[i] = taut_rods_[i].turns * multipliers[taut_rods_[i].row - 3 * movable_];
}

void Linkage::find_wave_inertia(std::span<const double> stiffness, std::span<const double> before, double h,
                                std::span<double> out) const {
  // A blow pulls in one substep alone.
  for (std::size_t i = 0; i < taut_rods_.size(); ++i)
    out[i] = slower *
             std::max(0.0, h * h * std::min(stiffness[i], before[i]) - resolved / taut_rods_[i].over_mass);
}

void Linkage::gather_wave_inertia(std::span<const double> inertia, std::span<double> of_particles) const {
  for (std::size_t i = 0; i < taut_rods_.size(); ++i)
    for (const std::uint32_t end : {taut_rods_[i].a, taut_rods_[i].b}) of_particles[end] += inertia[i];
}

void Linkage::add_wave_inertia(std::span<const double> inertia, std::span<simd::Block> matrix) const {
  const std::span<double> values{matrix.front().of, matrix.size() * (sizeof(simd::Block) / sizeof(double))};
  for (std::size_t i = 0; i < taut_rods_.size(); ++i) {
    if (inertia[i] == 0) continue;
    for (std::uint32_t k = 0; k < 9; ++k)
      if (taut_rods_[i].places[k] != none)
        values[taut_rods_[i].places[k]] += k < 6 ? inertia[i] : -inertia[i];
  }
}

void Linkage::add_wave_momenta(std::span<const double> inertia, std::span<const double> most,
                               std::span<const Vec3> v, std::span<Vec3> out) const {
  for (std::size_t i = 0; i < taut_rods_.size(); ++i) {
    if (inertia[i] == 0) continue;
    const auto [a, b] = std::pair{taut_rods_[i].a, taut_rods_[i].b};
    const double moving = std::min(inertia[i], most[i]);
    const Vec3 by = moving * ((b < movable_ ? v[b] : Vec3{}) - (a < movable_ ? v[a] : Vec3{}));
    if (a < movable_) out[a] = out[a] - by;
    if (b < movable_) out[b] += by;
  }
}

void Linkage::count_wave_pulls(std::span<const double> inertia, std::span<const double> most,
                               std::span<const Vec3> before, std::span<const Vec3> after,
                               LinkagePulls& pulls) const {
  for (std::size_t i = 0; i < taut_rods_.size(); ++i) {
    const auto [moves, stays] = std::minmax(taut_rods_[i].a, taut_rods_[i].b);
    if (inertia[i] == 0 || stays < movable_) continue;
    pulls.fixed[stays - movable_] +=
        inertia[i] * after[moves] - std::min(inertia[i], most[i]) * before[moves];
  }
}

double Linkage::wave_product(std::span<const double> inertia, std::span<const Vec3> v) const {
  double sum = 0;
  for (std::size_t i = 0; i < taut_rods_.size(); ++i) {
    if (inertia[i] == 0) continue;
    const auto [a, b] = std::pair{taut_rods_[i].a, taut_rods_[i].b};
    const Vec3 by = (b < movable_ ? v[b] : Vec3{}) - (a < movable_ ? v[a] : Vec3{});
    sum += inertia[i] * dot(by, by);
  }
  return sum;
}

}  // namespace plumb::detail
