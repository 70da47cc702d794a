#pragma once

#include <array>
#include <cstdint>
#include <optional>

#include "plumb/vec3.hpp"

/// @file
/// This file holds what shapes of all kinds have in common: how they feel, what they may touch, and how
/// ground moves.
namespace plumb {

/// Says how something feels when touched. Of two surfaces the larger restitution and resistances count, and
/// the geometric mean of their friction.
struct Surface {
  double friction = 0.5;   ///< Coulomb's coefficient.
  double restitution = 0;  ///< Share of the normal velocity that is kept, 0 to 1 (thesis eq. 2.32).
  /// Length in m. Rolling is resisted by a torque of at most this times the normal force. Soft wheels have
  /// some hundredths of their radius.
  double rolling = 0;
  /// Length in m. Spinning about the normal is resisted by a torque of at most this times the normal force. A
  /// patch of radius a, pressed evenly, has 2/3 a times its friction.
  double spinning = 0;
};

/// Says what a shape may touch. Two shapes may touch if the category of each is in the mask of the other.
///
/// Where both have the same group other than 0, that alone decides: they touch if it is positive, and do not
/// if it is negative.
struct Filter {
  std::uint32_t category = 1;       ///< Bits, what the shape is.
  std::uint32_t mask = 0xffffffff;  ///< Bits of the categories that it may touch.
  std::int32_t group = 0;           ///< Group that it belongs to; 0 is none.
  /// Whether it may touch shapes of its own island that say so, too. Neighbours never touch: those that rods
  /// join over no more than the sum of their radii, or that share a pin. So it is with capsules of two
  /// islands at one fixed particle. Of shapes other than capsules it is refused.
  bool own_island = false;

  /// Returns whether all members are equal.
  friend constexpr bool operator==(const Filter&, const Filter&) = default;
};

/// Returns whether shapes with these filters may touch.
constexpr bool may_touch(const Filter& a, const Filter& b) {
  if (a.group != 0 && a.group == b.group) return a.group > 0;
  return (a.category & b.mask) != 0 && (b.category & a.mask) != 0;
}

/// Says where something is and how it is turned.
struct Pose {
  Vec3 position{};                                ///< Place of its origin, in m.
  std::array<double, 4> orientation{1, 0, 0, 0};  ///< Unit quaternion w, x, y, z.

  /// Returns whether all members are equal.
  friend constexpr bool operator==(const Pose&, const Pose&) = default;
};

/// Says how ground moves. By default it stands still.
struct GroundMotion {
  /// Index into Scene::platforms of what carries it, if anything does. The ground is described as it is while
  /// the platform has the pose of the scene.
  std::optional<std::uint32_t> platform{};
  /// Velocity of the surface over the ground in m/s, as of a conveyor belt; its part along a contact's normal
  /// does not count. It turns with the platform.
  Vec3 belt{};
};

}  // namespace plumb
