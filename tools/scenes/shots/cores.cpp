#include "scenes/shots/cores.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "plumb/joints.hpp"
#include "scenes/humanoid/limbs.hpp"

namespace plumb::scenes {
namespace {

/// Returns the least of measure(target, missile, distance of their lines) over all pairs.
template <class Measure>
double least_over_pairs(std::span<const Core> targets, std::span<const Core> missiles,
                        std::span<const Vec3> positions, Vec3 way, Measure measure) {
  double least = std::numeric_limits<double>::infinity();
  for (const Core& missile : missiles) {
    const Vec3 a = place_of(missile.a, positions) + way, b = place_of(missile.b, positions) + way;
    for (const Core& target : targets) {
      const double apart =
          distance_of_lines(place_of(target.a, positions), place_of(target.b, positions), a, b);
      least = std::min(least, measure(target, missile, apart));
    }
  }
  return least;
}

}  // namespace

std::array<double, 3> half_sides(const Hull& box) {
  std::array<double, 3> out{};
  for (std::size_t axis = 0; axis < 3; ++axis)
    out[axis] = norm(box.points[std::size_t{1} << axis] - box.points[0]) / 2;
  return out;
}

void append_cores(const Scene& scene, std::size_t first_capsule, std::size_t first_hull,
                  std::vector<Core>& cores) {
  for (std::size_t i = first_capsule; i < scene.capsules.size(); ++i) {
    const Capsule& each = scene.capsules[i];
    cores.push_back({each.a, each.b, each.radius, each.radius});
  }
  for (std::size_t i = first_hull; i < scene.hulls.size(); ++i) {
    const Hull& each = scene.hulls[i];
    const Vec3 center = scene.bodies[each.body].center;
    const Point middle = point_on_body(scene, each.body, center);
    // The hulls of shots are boxes: the middles of opposite faces are as far apart as the box is thick.
    double inner = std::numeric_limits<double>::infinity(), outer = 0;
    for (const Vec3 corner : each.points) outer = std::max(outer, norm(corner - center));
    for (const double side : half_sides(each)) inner = std::min(inner, side);
    cores.push_back({middle, middle, inner + each.radius, outer + each.radius});
  }
}

double distance_of_lines(Vec3 a0, Vec3 a1, Vec3 b0, Vec3 b1) {
  const Vec3 u = a1 - a0, v = b1 - b0, between = a0 - b0;
  const double uu = dot(u, u), uv = dot(u, v), vv = dot(v, v), ub = dot(u, between), vb = dot(v, between);
  const double area = uu * vv - uv * uv;
  double s = area > 1e-12 * uu * vv ? std::clamp((uv * vb - vv * ub) / area, 0.0, 1.0) : 0;
  double t = vv > 0 ? (uv * s + vb) / vv : 0;
  if (t < 0 || t > 1 || vv == 0) {
    t = std::clamp(t, 0.0, 1.0);
    s = uu > 0 ? std::clamp((uv * t - ub) / uu, 0.0, 1.0) : 0;
  }
  return norm(between + s * u - t * v);
}

double clearance(std::span<const Core> targets, std::span<const Core> missiles,
                 std::span<const Vec3> positions, Vec3 way) {
  return least_over_pairs(targets, missiles, positions, way, [](const Core& a, const Core& b, double apart) {
    return apart - a.outer - b.outer;
  });
}

double share_inside(std::span<const Core> targets, std::span<const Core> missiles,
                    std::span<const Vec3> positions) {
  return -least_over_pairs(targets, missiles, positions, {}, [](const Core& a, const Core& b, double apart) {
    return (apart - a.inner - b.inner) / std::min(a.inner, b.inner);
  });
}

bool flies_into(std::span<const Core> targets, std::span<const Core> missiles,
                std::span<const Vec3> positions, Vec3 way) {
  const double length = norm(way);
  double gone = 0;
  // What has flown by no more than the distance cannot have met anything.
  for (int i = 0; i < 10'000 && gone <= length; ++i) {
    const double left =
        least_over_pairs(targets, missiles, positions, (length > 0 ? gone / length : 0) * way,
                         [](const Core& a, const Core& b, double apart) {
                           return apart - a.inner - b.inner + 0.5 * std::min(a.inner, b.inner);
                         });
    if (left < 1e-9) return true;
    gone += left;
  }
  return false;
}

}  // namespace plumb::scenes
