#pragma once

#include <array>

#include "contact/shapes/hulls/convex.hpp"
#include "contact/shapes/touch.hpp"

namespace plumb::detail {

/// This is a box with its corners and normals, as a convex shape. It may be flat, which no hull of points
/// may.
class SolidBox {
 public:
  SolidBox() : SolidBox({}, {}, {}) {}
  /// Makes a box about a centre (m), of half of its sides (m) along the axes of a frame.
  SolidBox(Vec3 center, Vec3 half, const Frame3& frame);

  Convex shape() const;
  /// Returns half of the sides (m) of the box along the axes of space that holds it.
  Vec3 reach() const { return reach_; }

 private:
  std::array<Vec3, 8> corners_;
  std::array<Vec3, 6> normals_;
  Vec3 reach_;
};

}  // namespace plumb::detail
