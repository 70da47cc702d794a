#include "plumb/reference/bounding.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "scene/require_points.hpp"
#include "scene/second_moments.hpp"

namespace plumb {
namespace {

using detail::require_points;

Vec3 mean(std::span<const Vec3> points) {
  Vec3 sum;
  for (const Vec3 p : points) sum += p;
  return (1 / static_cast<double>(points.size())) * sum;
}

struct Interval {
  double low = std::numeric_limits<double>::infinity();
  double high = -low;

  void add(double x) {
    low = std::min(low, x);
    high = std::max(high, x);
  }
  double middle() const { return low + (high - low) / 2; }
  double half() const { return (high - low) / 2; }
};

Interval extent_along(Vec3 axis, std::span<const Vec3> points) {
  Interval extent;
  for (const Vec3 p : points) extent.add(dot(axis, p));
  return extent;
}

/// Returns how far a box reaches from its centre along a direction, times the direction's length.
double reach(const Obb& box, Vec3 direction) {
  return box.half_size.x * std::abs(dot(box.axis[0], direction)) +
         box.half_size.y * std::abs(dot(box.axis[1], direction)) +
         box.half_size.z * std::abs(dot(box.axis[2], direction));
}

bool separates(Vec3 direction, const Obb& a, const Obb& b) {
  return std::abs(dot(direction, b.center - a.center)) > reach(a, direction) + reach(b, direction);
}

}  // namespace

BoundingSphere bounding_sphere_of(std::span<const Vec3> points) {
  require_points(points);
  BoundingSphere sphere{.center = mean(points)};
  for (const Vec3 p : points) sphere.radius = std::max(sphere.radius, norm(p - sphere.center));
  return sphere;
}

BoundingCylinder bounding_cylinder_of(std::span<const Vec3> points) {
  require_points(points);
  const Interval up = extent_along({0, 1, 0}, points);
  const Vec3 middle = mean(points);
  BoundingCylinder cylinder{.center = {middle.x, up.middle(), middle.z}, .height = 2 * up.half()};
  for (const Vec3 p : points)
    cylinder.radius = std::max(cylinder.radius, std::hypot(p.x - middle.x, p.z - middle.z));
  return cylinder;
}

Aabb aabb_of(std::span<const Vec3> points) {
  require_points(points);
  Aabb box{points.front(), points.front()};
  for (const Vec3 p : points) {
    box.low = {std::min(box.low.x, p.x), std::min(box.low.y, p.y), std::min(box.low.z, p.z)};
    box.high = {std::max(box.high.x, p.x), std::max(box.high.y, p.y), std::max(box.high.z, p.z)};
  }
  return box;
}

Obb obb_of(std::span<const Vec3> points) {
  require_points(points);
  const Vec3 middle = mean(points);
  detail::Sym3 covariance;
  for (const Vec3 p : points) covariance += detail::outer(1, p - middle);
  Obb box{.axis = detail::principal_axes(covariance).axis};
  std::array<Interval, 3> extent;
  for (const Vec3 p : points)
    for (std::size_t k = 0; k < 3; ++k) extent[k].add(dot(box.axis[k], p - middle));
  box.center = middle;
  for (std::size_t k = 0; k < 3; ++k) box.center += extent[k].middle() * box.axis[k];
  box.half_size = {extent[0].half(), extent[1].half(), extent[2].half()};
  return box;
}

TwoLevels two_levels_of(std::span<const Vec3> points) {
  return {bounding_sphere_of(points), obb_of(points)};
}

bool overlap(const BoundingSphere& a, const BoundingSphere& b) {
  return norm(a.center - b.center) <= a.radius + b.radius;
}

bool overlap(const BoundingCylinder& a, const BoundingCylinder& b) {
  const Vec3 apart = a.center - b.center;
  return std::hypot(apart.x, apart.z) <= a.radius + b.radius &&
         std::abs(apart.y) <= (a.height + b.height) / 2;
}

bool overlap(const Aabb& a, const Aabb& b) {
  return a.low.x <= b.high.x && b.low.x <= a.high.x && a.low.y <= b.high.y && b.low.y <= a.high.y &&
         a.low.z <= b.high.z && b.low.z <= a.high.z;
}

bool overlap(const Obb& a, const Obb& b) {
  for (const Vec3 axis : a.axis)
    if (separates(axis, a, b)) return false;
  for (const Vec3 axis : b.axis)
    if (separates(axis, a, b)) return false;
  // The product of parallel edges is zero, which separates nothing, or noise, which is an axis like any
  // other.
  for (const Vec3 u : a.axis)
    for (const Vec3 v : b.axis)
      if (separates(cross(u, v), a, b)) return false;
  return true;
}

bool overlap_in_two_levels(const TwoLevels& a, const TwoLevels& b) {
  return overlap(a.sphere, b.sphere) && overlap(a.box, b.box);
}

}  // namespace plumb
