#include "contact/surroundings.hpp"

#include <algorithm>
#include <cmath>

namespace plumb::detail {

Surroundings::Surroundings(const Scene& scene) : planes(scene.planes) {
  for (const Box& box : scene.boxes) {
    const auto [w, x, y, z] = box.orientation;
    const Frame3 frame{{1 - 2 * (y * y + z * z), 2 * (x * y + w * z), 2 * (x * z - w * y)},
                       {2 * (x * y - w * z), 1 - 2 * (x * x + z * z), 2 * (y * z + w * x)},
                       {2 * (x * z + w * y), 2 * (y * z - w * x), 1 - 2 * (x * x + y * y)}};
    const auto far = [&](double a, double b, double c) {
      return std::abs(a) * box.half_size.x + std::abs(b) * box.half_size.y + std::abs(c) * box.half_size.z;
    };
    const Vec3 most{far(frame.x.x, frame.y.x, frame.z.x), far(frame.x.y, frame.y.y, frame.z.y),
                    far(frame.x.z, frame.y.z, frame.z.z)};
    boxes.push_back({box.center, box.half_size, frame, {box.center - most, box.center + most}, box.surface});
  }
}

bool Surroundings::reach_into(const Bounds& bounds) const {
  return std::any_of(planes.begin(), planes.end(),
                     [&](const Plane& plane) { return height(bounds, plane) <= 0; }) ||
         std::any_of(boxes.begin(), boxes.end(),
                     [&](const Solid& box) { return box.bounds.overlaps(bounds); });
}

double height(const Bounds& bounds, const Plane& plane) {
  const Vec3 center = 0.5 * (bounds.low + bounds.high), half = 0.5 * (bounds.high - bounds.low);
  const Vec3 n = plane.normal;
  return dot(n, center) - plane.offset -
         (std::abs(n.x) * half.x + std::abs(n.y) * half.y + std::abs(n.z) * half.z);
}

}  // namespace plumb::detail
