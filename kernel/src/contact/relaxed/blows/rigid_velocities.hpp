#pragma once

#include <algorithm>
#include <array>
#include <cstdint>
#include <utility>

#include "contact/relaxed/crowd.hpp"
#include "contact/relaxed/pairs/crowd_pairs.hpp"

namespace plumb::detail {

/// Gives the four particles of a body the rigid motion with their momentum and angular momentum, unless some
/// are fixed. of(place) says how a particle moves, and push(place, by) changes that.
template <class T, class Of, class Push>
void make_rigid(const Crowd<T>& crowd, std::uint32_t island, const std::array<std::uint32_t, 4>& particles,
                Of&& of, Push&& push) {
  std::array<double, 4> mass;
  std::array<Vec3, 4> from, v;
  std::array<std::uint32_t, 4> at;
  double all = 0;
  Vec3 middle{}, momentum{};
  for (std::size_t i = 0; i < 4; ++i) {
    const double inverse = crowd.inverse_mass(island, particles[i]);
    if (!(inverse > 0)) return;
    at[i] = crowd.number_of(island, particles[i]);
    mass[i] = 1 / inverse;
    from[i] = crowd.position(at[i]);
    v[i] = of(at[i]);
    all += mass[i];
    middle += mass[i] * from[i];
    momentum += mass[i] * v[i];
  }
  const Vec3 common = (1 / all) * momentum;
  Vec3 spin{}, x{}, y{}, z{};  // angular momentum, and columns of the inertia
  for (std::size_t i = 0; i < 4; ++i) {
    const Vec3 r = from[i] -= (1 / all) * middle;
    spin += mass[i] * cross(r, v[i] - common);
    x += mass[i] * (dot(r, r) * Vec3{1, 0, 0} - r.x * r);
    y += mass[i] * (dot(r, r) * Vec3{0, 1, 0} - r.y * r);
    z += mass[i] * (dot(r, r) * Vec3{0, 0, 1} - r.z * r);
  }
  const Vec3 yz = cross(y, z);
  const double size = dot(x, yz);
  if (!(size > 0)) return;
  spin = (1 / size) * Vec3{dot(yz, spin), dot(cross(z, x), spin), dot(cross(x, y), spin)};
  for (std::size_t i = 0; i < 4; ++i) push(at[i], common + cross(spin, from[i]) - v[i]);
}

/// Does so with velocities. A blow on one of a body's corners moves all of it then, as it does where rods are
/// solved.
template <class T>
void make_rigid(Crowd<T>& crowd, std::uint32_t island, const std::array<std::uint32_t, 4>& particles) {
  make_rigid(
      crowd, island, particles, [&](std::uint32_t at) { return crowd.velocity(at); },
      [&](std::uint32_t at, Vec3 by) { crowd.push_velocity(at, by); });
}

/// Returns the particles of the body that a shape or a hull of an island turns with, by its number; null if
/// that turns with none.
template <class T>
const std::array<std::uint32_t, 4>* body_under(const CrowdPairs<T>& near, std::uint32_t island,
                                               std::uint32_t number) {
  if (const auto* const hull = near.hull_of(island, number)) return &hull->shape->particles;
  const auto bodies = near.bodies();  // in the same order
  const auto at = std::partition_point(bodies.begin(), bodies.end(), [&](const auto& each) {
    return std::pair{each.island, each.number} < std::pair{island, number};
  });
  const bool is_there = at != bodies.end() && at->island == island && at->number == number;
  return is_there && at->turns ? &at->shape->turners : nullptr;
}

}  // namespace plumb::detail
