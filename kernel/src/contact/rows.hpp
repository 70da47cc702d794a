#pragma once

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <initializer_list>

#include "contact/linkage/linkage_state.hpp"
#include "contact/shapes/touch.hpp"
#include "contact/surroundings.hpp"

/// This file has what contacts have in common, whether they are solved or relaxed.
namespace plumb::detail {

/// Returns a place between two others, from 0 to 1.
inline Combination blend(Terms a, Terms b, double t) {
  if (t <= 0) return a;
  if (t >= 1) return b;
  Combination out;
  if (a.size() == 1 && b.size() == 1 && a[0].particle != b[0].particle) {
    // This is how most lines are.
    out.terms[0] = {a[0].particle, (1 - t) * a[0].weight};
    out.terms[1] = {b[0].particle, t * b[0].weight};
    out.count = 2;
  } else {
    for (const auto& [particle, weight] : a) out.add(particle, (1 - t) * weight);
    for (const auto& [particle, weight] : b) out.add(particle, t * weight);
  }
  return out;
}

/// Returns the gap (m) up to which a contact that seems not to come about in a substep is still watched. It
/// is a distance, times the length scale, and a multiple of what the contact's ends move (m).
inline double in_sight(double moves, double length_scale) {
  return 0.1 * length_scale + 2 * moves;
}

/// This is the place of a side on something fixed, which has no particles.
inline constexpr Combination no_particles{};

/// Kinds of what pushes, in a key's first bits, below the one of turning_key.
enum class KeyKind : std::uint8_t {
  plane = 1,
  box = 2,
  island = 3,
  angle = 4,
  segment = 5,
  ground = 6,
  hulls = 7
};

/// Says which part of a shape ground pushes: an end, the line, a hull or its corner; what is touched first;
/// or what went in unexpectedly.
enum class GroundPart : std::uint8_t { end, line, first_of_line, missed, hull, corner, first_of_hull };

/// Returns one number for the pair that touches, by which the next substep finds what held the contact. Its
/// first four bits are the kind, and the others are mixed (SplitMix64; Steele, Lea and Flood 2014), so that
/// islands may have any number of shapes.
inline std::uint64_t contact_key(KeyKind kind, std::uint64_t own, std::uint64_t island, std::uint64_t other) {
  std::uint64_t mixed = 0;
  for (const std::uint64_t part : {own, island, other}) {
    mixed = (mixed ^ part) + 0x9e3779b97f4a7c15;
    mixed = (mixed ^ (mixed >> 30)) * 0xbf58476d1ce4e5b9;
    mixed = (mixed ^ (mixed >> 27)) * 0x94d049bb133111eb;
    mixed ^= mixed >> 31;
  }
  return static_cast<std::uint64_t>(kind) << 60 | mixed >> 4;
}

/// Returns the key of a contact with ground that is neither a plane nor carried by a platform.
inline std::uint64_t ground_key(GroundPart part, std::uint64_t number, std::uint64_t ground,
                                std::uint64_t which) {
  return contact_key(KeyKind::ground, static_cast<std::uint64_t>(part) << 40 | number, ground, which);
}

inline KeyKind kind_of(std::uint64_t key) {
  return static_cast<KeyKind>(key >> 60);
}

/// Returns whether the number of another island is mixed into a key.
inline bool names_island(std::uint64_t key) {
  return kind_of(key) == KeyKind::island || kind_of(key) == KeyKind::hulls;
}

/// This is in the key of what resists turning at a contact.
inline constexpr std::uint64_t turning_key = std::uint64_t{1} << 63;

/// Returns the forces that held the contact `key` in the last substep. Nothing held it if the result has
/// another key. Contacts are found in about the same order again, so the search goes on from `next`.
inline KeptContact kept_at(const LinkageState& state, std::uint64_t key, std::size_t& next) {
  for (std::size_t tried = 0; tried < state.kept.size(); ++tried, ++next) {
    if (next >= state.kept.size()) next = 0;
    if (state.kept[next].key == key) return state.kept[next++];
  }
  return {};
}

/// Returns the speed (m/s) at which a contact closes. `closing` (m) is how its gap changes in a substep of h
/// (s), and `arriving` (m/s) its rate now. What is gained on the way is included.
inline double approach_of(double gap, double closing, double arriving, double h) {
  const double gain = 2 * (closing - h * arriving) / (h * h);
  const double square = arriving * arriving - 2 * gain * std::max(gap, 0.0);
  return arriving < 0 ? std::sqrt(std::max(square, 0.0)) : 0;
}

/// Likewise of a relaxed substep. Its prediction goes on at the velocity of its end, so that `closing` has
/// twice what is gained on the way.
inline double relaxed_approach_of(double gap, double closing, double arriving, double h) {
  return approach_of(gap, 0.5 * (closing + h * arriving), arriving, h);
}

/// Returns the speed (m/s) with which a contact leaves the surface that it hits at `approach`.
inline double bounce_of(double restitution, double least, double approach) {
  return approach > least ? restitution * approach : 0;
}

/// Returns what a contact or a limit must keep of a gap (m or rad). A gap that is open may close. Of an
/// overlap beyond `slop`, `share` is taken back, but not more than all of it.
inline double recovered(double gap, double slop, double share) {
  return gap >= 0 ? gap : std::min(0.0, std::min(share, 1.0) * (gap + slop));
}

/// Calls add(number, t, touch) for all places, at t from 0 to 1, where a line from p to q with a radius is to
/// be kept off a box. Lines are given in the box's axes (m), and normals in those of space.
template <class Add>
void for_touches_with_box(Vec3 p, Vec3 q, double radius, const Surroundings::Solid& box, Add&& add) {
  const double nearest = p == q ? 0 : nearest_to_box(p, q, box.half);
  std::uint64_t which = 0;
  for (const double t : touching_box(p, q, box.half, nearest)) {
    ++which;
    if (which > 1 && (!(t >= 0 && t <= 1) || p == q || std::abs(t - nearest) < 1e-3)) continue;
    Touch touch = touch_box(between(p, q, t), radius, box.half);
    touch.normal = box.frame.to_space(touch.normal);
    add(which, t, touch);
  }
}

}  // namespace plumb::detail
