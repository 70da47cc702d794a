#pragma once

#include <cstdint>

#include "plumb/scene.hpp"

/// These scenes bend and twist.
namespace plumb::scenes {

/// A wire lies straight along +x from the origin, where it is clamped. Its last cross section is turned
/// against the clamp, so that it leaves the plane in which it sags.
struct WireShape {
  std::uint32_t rods = 20;
  double length = 1;   ///< Length, in m.
  double mass = 1;     ///< Mass, in kg.
  double bending = 1;  ///< Bending stiffness E I, in N m².
  double torsion = 1;  ///< Torsional stiffness G J, in N m²; 0 means that nothing resists twist.
  double twist = 3;    ///< Twist at the start, in rad.
};

/// Makes such a scene. Throws InputError with the value that makes no sense.
Scene make_wire(const WireShape& shape);

}  // namespace plumb::scenes
