#pragma once

#include "plumb/scene.hpp"

namespace plumb {

// Capsules that were added are compared in all members.

inline bool operator==(const Point& a, const Point& b) {
  return a.particles == b.particles && a.weights == b.weights;
}
inline bool operator==(const Surface& a, const Surface& b) {
  return a.friction == b.friction && a.restitution == b.restitution && a.rolling == b.rolling &&
         a.spinning == b.spinning;
}
inline bool operator==(const Capsule& a, const Capsule& b) {
  return a.a == b.a && a.b == b.b && a.radius == b.radius && a.surface == b.surface && a.filter == b.filter;
}

}  // namespace plumb
