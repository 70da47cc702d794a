#pragma once

#include <compare>
#include <cstdint>
#include <string_view>

#include "plumb/export.hpp"
#include "plumb/vec3.hpp"

/// @file
/// This file holds what a world says of shapes that touch each other and the ground, see World::contacts().
namespace plumb {

/// Says which list of a scene a shape or a piece of ground stands in.
enum class ShapeKind : std::uint8_t {
  capsule,
  hull,
  plane,
  box,
  ground_capsule,
  ground_hull,
  mesh,
  height_field
};
/// Returns the name of a list, in the singular, as files spell it.
PLUMB_API std::string_view to_string(ShapeKind);

/// Names a shape, or a piece of ground, by its place in the scene. They are ordered by list, then by number.
struct ShapeId {
  ShapeKind kind = ShapeKind::capsule;  ///< Its list; a capsule on anchors is a capsule, too.
  std::uint32_t number = 0;             ///< Index into that list.

  /// Compares by list, then by number.
  friend constexpr auto operator<=>(const ShapeId&, const ShapeId&) = default;
};

/// Says whether a pair touched in a step and not in the one before, in both, or in the one before alone.
enum class ContactPhase : std::uint8_t { began, persisted, ended };
/// Returns the name of a phase, as files spell it.
PLUMB_API std::string_view to_string(ContactPhase);

/// Says how two shapes touched in a step. A pair touches if one pushed the other in some substep, however
/// short and at however many points, which are taken together.
struct Contact {
  ShapeId a{};                               ///< The shape that comes first in their order.
  ShapeId b{};                               ///< The other one.
  ContactPhase phase = ContactPhase::began;  ///< What came of it in the step.
  /// Where they touched, in m: half way between their surfaces as substeps ended, averaged by the impulses
  /// along the normal. Of an ended one it is where they touched last, as is the normal.
  Vec3 point{};
  Vec3 normal{};  ///< Unit vector from b to a, averaged likewise.
  Vec3
      impulse{};  ///< On a, friction included, over the step, in N s; b gets the opposite. Ended ones have 0.
  /// Speed at which they met, in m/s: the largest along a normal over points and substeps, just before they
  /// pushed. Of what rests it is 0 but for rounding, and so it is of an ended one.
  double approach_speed = 0;
};

}  // namespace plumb
