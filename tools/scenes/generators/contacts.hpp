#pragma once

#include "plumb/scene.hpp"

/// Small scenes in which things touch.
namespace plumb::scenes {

/// The thesis's stick in a box (section 3.2.3, figure 3.6, units as metres): two particles of 1 kg, 100 m
/// apart (eq. 3.7), between six planes that keep their places from 0 to 500 m (eq. 3.8). Thrown from the
/// middle of the box, turning.
struct StickBoxShape {
  double length = 100;       ///< m, of the stick
  double size = 500;         ///< m, of the box
  double speed = 60;         ///< m/s, of the stick's middle
  double spin = 0.5;         ///< rad/s, about z
  double restitution = 0.5;  ///< of stick and walls
  double friction = 0.2;
};

/// A ball above a plane, at rest.
struct DropShape {
  double height = 1;  ///< m, of its lowest point above the plane
  double radius = 0.1;
  double mass = 1;
  double restitution = 0.5;
  double friction = 0.5;
};

/// Each throws InputError naming the value that makes no sense.
Scene make_stick_box(const StickBoxShape& shape);
Scene make_drop(const DropShape& shape);

}  // namespace plumb::scenes
