#pragma once

#include <array>
#include <cmath>
#include <cstdint>

#include "contact/shapes/hulls/convex.hpp"
#include "plumb/shapes/queries.hpp"
#include "queries/query_tree.hpp"
#include "queries/solid_box.hpp"

namespace plumb::detail {

/// This is what is cast: a point, a ball about it, or a box about it, that goes along a unit vector.
struct Probe {
  Vec3 origin{}, direction{};
  double length = 0;              ///< m, how far it goes
  double radius = 0;              ///< m, of a ball
  const SolidBox* box = nullptr;  ///< where it starts

  /// Returns half of the sides (m) of what holds it.
  Vec3 reach() const { return box ? box->reach() : Vec3{radius, radius, radius}; }
  Way way() const { return {origin, direction, reach()}; }
  /// Returns it where it starts; a point has its origin as its vertex.
  Convex shape() const {
    return box ? box->shape() : Convex{.vertices = {&origin, 1}, .normals = {}, .radius = radius};
  }
  Vec3 at(double distance) const { return origin + distance * direction; }
};

/// Says where something is met, or where its surface is nearest.
struct Strike {
  double distance = INFINITY;  ///< m, along the way, or from the surface
  Vec3 normal{};               ///< unit vector out of the surface
  Vec3 point{};                ///< m, on the surface

  /// Returns whether anything is met.
  explicit operator bool() const { return distance < INFINITY; }
};

/// Takes the nearest of what is found. Of equal distances the lowest number counts, so that the order of the
/// search does not.
struct Nearest {
  Strike strike{};
  std::uint32_t number = 0xffffffff;
  std::uint32_t thing = 0xffffffff;  ///< its place in the list, if it has one

  /// Returns whether a number at this distance (m) comes before what was found.
  bool is_beaten_by(double distance, std::uint32_t by) const {
    return distance < strike.distance || (distance == strike.distance && by < number);
  }
};

}  // namespace plumb::detail
