#pragma once

#include "plumb/scene.hpp"

/// These are small scenes in which things touch.
namespace plumb::scenes {

/// This is the thesis's stick in a box (section 3.2.3, figure 3.6), with its units as metres. Two particles
/// of 1 kg are 100 m apart (eq. 3.7). Six planes keep their places from 0 to 500 m (eq. 3.8). The stick is
/// thrown from the middle of the box and turns.
struct StickBoxShape {
  double length = 100;       ///< Length of the stick, in m.
  double size = 500;         ///< Side of the box, in m.
  double speed = 60;         ///< Speed of the stick's middle, in m/s.
  double spin = 0.5;         ///< Angular velocity about z, in rad/s.
  double restitution = 0.5;  ///< Restitution of stick and walls, 0 to 1.
  double friction = 0.2;
};

/// A ball rests above a plane.
struct DropShape {
  double height = 1;  ///< Height of its lowest point above the plane, in m.
  double radius = 0.1;
  double mass = 1;
  double restitution = 0.5;
  double friction = 0.5;
};

/// Makes such a scene. Throws InputError with the value that makes no sense.
Scene make_stick_box(const StickBoxShape& shape);
Scene make_drop(const DropShape& shape);

}  // namespace plumb::scenes
