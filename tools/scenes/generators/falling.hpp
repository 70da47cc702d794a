#pragma once

#include <cstdint>

#include "plumb/scene.hpp"

/// These are ropes and nets that fall on ground and on each other.
namespace plumb::scenes {

/// A rope of capsules falls on a plane: level, with ripples of 1 mm, or wound to a coil, which touches
/// itself.
struct RopeShape {
  std::uint32_t links = 100;
  double length = 0.1;   ///< Length of a rod, in m.
  double mass = 0.1;     ///< Mass of a particle, in kg.
  double radius = 0.02;  ///< Of a capsule, in m.
  double height = 0.3;   ///< Height of its lower end above where it lies, in m.
  double coil = 0;       ///< Radius of a coil, in m. A rope without one is level.
  double pitch = 0;      ///< Height of a turn of the coil, in m; 0 is three radii of a capsule.
  double friction = 0.5;
};

/// Level ropes fall on a plane and on each other.
struct HeapShape {
  std::uint32_t ropes = 16;
  std::uint32_t links = 20;
  double length = 0.1;   ///< Length of a rod, in m.
  double mass = 0.1;     ///< Mass of a particle, in kg.
  double radius = 0.02;  ///< Of a capsule, in m.
  double spacing = 0.1;  ///< Height between ropes, in m.
  double friction = 0.5;
  std::uint32_t seed = 1;
};

/// A level square net falls on a plane, a box or a sphere.
struct DrapeShape {
  std::uint32_t size = 32;  ///< Particles along a side.
  double spacing = 0.05;    ///< Length of a rod, in m.
  double mass = 0.01;       ///< Mass of a particle, in kg.
  double radius = 0.01;     ///< Of a capsule, in m.
  double height = 0.1;      ///< Height above what it falls on, in m.
  double friction = 0.5;
  std::uint32_t box = 1;     ///< 0: there is no box, of half the net's side.
  std::uint32_t sphere = 0;  ///< 1: there is a sphere instead of the box, as wide as that.
};

/// Stacks of level ropes, side by side, fall on hilly ground of triangles and on each other.
struct TerrainShape {
  std::uint32_t ropes = 40;
  std::uint32_t links = 32;
  double length = 0.1;             ///< Length of a rod, in m.
  double mass = 0.1;               ///< Mass of a particle, in kg.
  double radius = 0.02;            ///< Of a capsule, in m.
  double spacing = 0.1;            ///< Height between the ropes of a stack, in m.
  std::uint32_t stack = 40;        ///< Ropes above each other, at most.
  std::uint32_t triangles = 2000;  ///< Of the ground, which is a square grid of the next larger number.
  double hills = 0.3;              ///< Height of hills, and depth of valleys, at most, in m.
  double friction = 0.5;
  std::uint32_t seed = 1;
};

/// Solid boxes, each turned at random, fall on a plane and on each other.
struct BoxesShape {
  std::uint32_t boxes = 5;
  double size = 0.2;    ///< Half of the sum of a box's shortest and longest side, in m.
  double mass = 1;      ///< Mass of a box, in kg.
  double height = 0.1;  ///< Height of the lowest one above the plane, and gap between them, in m.
  double friction = 0.5;
  std::uint32_t seed = 1;
};

/// Makes such a scene. Throws InputError with the value that makes no sense.
Scene make_rope(const RopeShape& shape);
Scene make_heap(const HeapShape& shape);
Scene make_drape(const DrapeShape& shape);
Scene make_terrain(const TerrainShape& shape);
Scene make_boxes(const BoxesShape& shape);

}  // namespace plumb::scenes
