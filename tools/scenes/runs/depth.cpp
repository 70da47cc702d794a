#include "scenes/runs/depth.hpp"

#include <algorithm>
#include <cmath>

#include "plumb/joints.hpp"
#include "scenes/humanoid/limbs.hpp"

namespace plumb::scenes {
namespace {

/// Returns how far a point is from a box's surface, in m; negative inside.
double distance_from(const Box& box, Vec3 at) {
  const Vec3 in = to_axes(box, at - box.center);
  const Vec3 out{std::abs(in.x) - box.half_size.x, std::abs(in.y) - box.half_size.y,
                 std::abs(in.z) - box.half_size.z};
  const double most = std::max({out.x, out.y, out.z});
  return most < 0 ? most : norm(Vec3{std::max(out.x, 0.0), std::max(out.y, 0.0), std::max(out.z, 0.0)});
}

/// Returns how far a point is from the surface of a capsule of the ground, in m; negative inside.
double distance_from(const GroundCapsule& capsule, Vec3 at) {
  const Vec3 line = capsule.b - capsule.a;
  const double length2 = dot(line, line);
  const double share = length2 > 0 ? std::clamp(dot(at - capsule.a, line) / length2, 0.0, 1.0) : 0;
  return norm(at - capsule.a - share * line) - capsule.radius;
}

double depth_of(const Scene& scene, Vec3 at, double radius) {
  double deepest = 0;
  for (const Plane& plane : scene.planes)
    deepest = std::max(deepest, radius + plane.offset - dot(plane.normal, at));
  for (const Box& box : scene.boxes) deepest = std::max(deepest, radius - distance_from(box, at));
  for (const GroundCapsule& capsule : scene.ground_capsules)
    deepest = std::max(deepest, radius - distance_from(capsule, at));
  return deepest;
}

}  // namespace

double depth_in_ground(const Scene& scene, std::span<const Vec3> positions) {
  double deepest = 0;
  for (const Capsule& capsule : scene.capsules)
    for (const Point* point : {&capsule.a, &capsule.b})
      deepest = std::max(deepest, depth_of(scene, place_of(*point, positions), capsule.radius));
  for (const Hull& hull : scene.hulls)
    for (const Vec3 corner : hull.points) {
      const Vec3 at = place_of(point_on_body(scene, hull.body, corner), positions);
      deepest = std::max(deepest, depth_of(scene, at, hull.radius));
    }
  return deepest;
}

Vec3 to_axes(const Box& box, Vec3 v) {
  const auto& [w, x, y, z] = box.orientation;
  const Vec3 about{-x, -y, -z}, twice = 2 * cross(about, v);
  return v + w * twice + cross(about, twice);
}

}  // namespace plumb::scenes
