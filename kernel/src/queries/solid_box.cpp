#include "queries/solid_box.hpp"

#include <cmath>

#include "contact/shapes/hulls/convex_hull.hpp"

namespace plumb::detail {
namespace {

/// Returns the cube of which all boxes have the corners and faces.
const ConvexHull& cube() {
  static const ConvexHull made = [] {
    std::array<Vec3, 8> corners;
    for (std::size_t i = 0; i < 8; ++i)
      corners[i] = {i & 1 ? 1.0 : -1.0, i & 2 ? 1.0 : -1.0, i & 4 ? 1.0 : -1.0};
    return ConvexHull(corners);
  }();
  return made;
}

}  // namespace

SolidBox::SolidBox(Vec3 center, Vec3 half, const Frame3& frame) {
  const Convex unit = cube().shape(0);
  for (std::size_t i = 0; i < 8; ++i) {
    const Vec3 v = unit.vertices[i];
    corners_[i] = center + frame.to_space({v.x * half.x, v.y * half.y, v.z * half.z});
  }
  for (std::size_t i = 0; i < 6; ++i) normals_[i] = frame.to_space(unit.normals[i]);
  const auto far = [&](double x, double y, double z) {
    return std::abs(x) * half.x + std::abs(y) * half.y + std::abs(z) * half.z;
  };
  reach_ = {far(frame.x.x, frame.y.x, frame.z.x), far(frame.x.y, frame.y.y, frame.z.y),
            far(frame.x.z, frame.y.z, frame.z.z)};
}

Convex SolidBox::shape() const {
  return {.vertices = corners_, .normals = normals_, .parts = &cube().parts(), .radius = 0};
}

}  // namespace plumb::detail
