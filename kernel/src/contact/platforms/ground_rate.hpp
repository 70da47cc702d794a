#pragma once

#include "plumb/vec3.hpp"

namespace plumb::detail {

/// Says how fast ground moves: a rigid motion, and a belt over its surface.
struct GroundRate {
  Vec3 center{};    ///< m, a place that moves at `velocity`
  Vec3 velocity{};  ///< m/s
  Vec3 spin{};      ///< 1/s
  Vec3 belt{};      ///< m/s, of the surface over the ground

  /// Returns whether the ground or its surface moves.
  bool moves() const { return velocity != Vec3{} || spin != Vec3{} || belt != Vec3{}; }
  /// Returns the velocity (m/s) of the surface at a place (m) with this normal.
  Vec3 at(Vec3 place, Vec3 normal) const {
    return velocity + cross(spin, place - center) + belt - dot(belt, normal) * normal;
  }
  /// Returns how far (m) the surface at a place goes in `h` (s). Across the normal that is exact, which takes
  /// what sticks to it round. Along it that is the rate at the start, so that round ground does not sink.
  Vec3 moved(Vec3 place, Vec3 normal, double h) const;
  /// Returns the rate `h` (s) later.
  GroundRate later(double h) const {
    GroundRate out = *this;
    out.center += h * velocity;
    return out;
  }
};

}  // namespace plumb::detail
