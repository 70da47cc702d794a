#pragma once

#include <span>

#include "contact/linkage/linkage_state.hpp"
#include "contact/shapes/bounds.hpp"

namespace plumb::detail {

/// Returns a box around a linkage's shapes, with particles at x.
inline Bounds bounds_of(const Linkage& linkage, std::span<const Vec3> x, double further) {
  Bounds out = nowhere;
  for (const Linkage::Ball& ball : linkage.balls()) include(out, ball.center.of(x), ball.radius + further);
  return out;
}

}  // namespace plumb::detail
