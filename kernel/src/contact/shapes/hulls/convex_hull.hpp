#pragma once

#include <span>

#include "contact/shapes/bounds.hpp"
#include "contact/shapes/hulls/convex.hpp"
#include "plumb/layouts/memory.hpp"

namespace plumb::detail {

/// This is the convex hull of points: its corners, its faces, which may have any number of them, and its
/// edges. Points on faces and edges are no corners.
class ConvexHull {
 public:
  ConvexHull() = default;
  /// Builds the hull, which is empty if the points lie in one plane, to within `flat` of their size.
  /// Throws InputError if rounding leaves its surface open.
  explicit ConvexHull(std::span<const Vec3> points);

  /// Returns the same faces over corners that moved, of which there are as many as this has, in its order.
  ConvexHull moved_to(std::span<const Vec3> corners) const;

  bool is_empty() const { return vertices_.empty(); }
  std::span<const Vec3> vertices() const { return vertices_; }
  /// Returns the corners' numbers among the points.
  std::span<const std::uint32_t> numbers() const { return numbers_; }
  const ConvexParts& parts() const { return parts_; }
  Convex shape(double radius) const { return {vertices_, normals_, &parts_, radius}; }
  Bounds bounds() const;

  static constexpr double flat = 1e-7;

 private:
  Array<Vec3> vertices_, normals_;
  Array<std::uint32_t> numbers_;
  ConvexParts parts_;
};

/// Computes the unit normals of faces whose vertices have moved.
void find_normals(const ConvexParts& parts, std::span<const Vec3> vertices, std::span<Vec3> normals);

}  // namespace plumb::detail
