#pragma once

#include <algorithm>
#include <array>
#include <cmath>

#include "plumb/scene.hpp"

/// These functions look at a scene from a corner above, without perspective.
namespace plumb::tools {

/// A point as it is seen: to the right, up and towards the eye, in m.
struct Seen {
  double right, up, near;
};
/// Looks from 30° to the side and 25° down.
Seen seen(Vec3 at);
/// A level circle is seen as an ellipse. Returns its height over its width.
double flatness_of_level();

/// A part of what can be seen, in m.
struct Window {
  double left = INFINITY, right = -INFINITY, low = INFINITY, high = -INFINITY, far = INFINITY,
         near = -INFINITY;

  void take_in(const Seen& at, double radius) {
    left = std::min(left, at.right - radius);
    right = std::max(right, at.right + radius);
    low = std::min(low, at.up - radius);
    high = std::max(high, at.up + radius);
    far = std::min(far, at.near);
    near = std::max(near, at.near);
  }
};

/// Returns whether a box or a capsule of the ground is between a place and the eye.
bool is_hidden(const Scene& scene, Vec3 at);

}  // namespace plumb::tools
