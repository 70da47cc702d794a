#pragma once

#include <algorithm>
#include <array>
#include <cstdint>
#include <optional>
#include <utility>

#include "contact/relaxed/bodies/rigid_frame.hpp"
#include "contact/relaxed/crowd.hpp"
#include "contact/relaxed/pairs/crowd_pairs.hpp"

namespace plumb::detail {

/// Gives the four particles of a body the rigid motion with their momentum and angular momentum, unless some
/// are fixed. of(place) says how a particle moves, and push(place, by) changes that.
template <class T, class Of, class Push>
void make_rigid(const Crowd<T>& crowd, std::uint32_t island, const std::array<std::uint32_t, 4>& particles,
                Of&& of, Push&& push) {
  const std::optional<RigidFrame> frame = rigid_frame(crowd, island, particles);
  if (!frame) return;
  std::array<Vec3, 4> v;
  Vec3 momentum{}, angular{};
  for (std::size_t i = 0; i < 4; ++i) {
    v[i] = of(frame->at[i]);
    momentum += frame->mass[i] * v[i];
  }
  const Vec3 common = frame->inverse_mass * momentum;
  for (std::size_t i = 0; i < 4; ++i) angular += frame->mass[i] * cross(frame->offsets[i], v[i] - common);
  const auto& [x, y, z] = frame->adjugate;
  const Vec3 spin = (1 / frame->determinant) * Vec3{dot(x, angular), dot(y, angular), dot(z, angular)};
  for (std::size_t i = 0; i < 4; ++i) push(frame->at[i], common + cross(spin, frame->offsets[i]) - v[i]);
}

/// Does so with velocities. A blow on one of a body's corners moves all of it then, as it does where rods are
/// solved.
template <class T>
void make_rigid(Crowd<T>& crowd, std::uint32_t island, const std::array<std::uint32_t, 4>& particles) {
  make_rigid(
      crowd, island, particles, [&](std::uint32_t at) { return crowd.velocity(at); },
      [&](std::uint32_t at, Vec3 by) { crowd.push_velocity(at, by); });
}

/// Does so with displacements.
template <class T>
void move_rigidly(Crowd<T>& crowd, std::uint32_t island, const std::array<std::uint32_t, 4>& particles) {
  make_rigid(
      crowd, island, particles, [&](std::uint32_t at) { return crowd.moved(at); },
      [&](std::uint32_t at, Vec3 by) { crowd.push(at, by); });
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
