#include "fall/measure.hpp"

#include <algorithm>
#include <cmath>

#include "scenes/basics/clock.hpp"
#include "scenes/humanoid/limbs.hpp"
#include "scenes/spec.hpp"

namespace plumb::tools {
namespace {

/// Returns how far a point is from a box's surface, in m; negative inside.
double distance_from(const Box& box, Vec3 at) {
  const Vec3 in = to_axes(box, at - box.center);
  const Vec3 out{std::abs(in.x) - box.half_size.x, std::abs(in.y) - box.half_size.y,
                 std::abs(in.z) - box.half_size.z};
  const double most = std::max({out.x, out.y, out.z});
  return most < 0 ? most : norm(Vec3{std::max(out.x, 0.0), std::max(out.y, 0.0), std::max(out.z, 0.0)});
}

}  // namespace

double depth_in_ground(const Scene& scene, std::span<const Vec3> positions) {
  double deepest = 0;
  for (const Capsule& capsule : scene.capsules)
    for (const Point* point : {&capsule.a, &capsule.b}) {
      const Vec3 at = scenes::place_of(*point, positions);
      for (const Plane& plane : scene.planes)
        deepest = std::max(deepest, capsule.radius + plane.offset - dot(plane.normal, at));
      for (const Box& box : scene.boxes) deepest = std::max(deepest, capsule.radius - distance_from(box, at));
    }
  return deepest;
}

Vec3 to_axes(const Box& box, Vec3 v) {
  const auto& [w, x, y, z] = box.orientation;
  const Vec3 about{-x, -y, -z}, twice = 2 * cross(about, v);
  return v + w * twice + cross(about, twice);
}

FallResult run_fall(const Fall& fall) {
  const Scene scene = scenes::load_scene(fall.scene);
  World world(scene, fall.settings);
  FallResult result{.rods = scene.rods.size()};
  Frame now;
  now.positions.resize(scene.particles.size());
  std::vector<double> times;
  const auto keep = [&](std::uint32_t frame) {
    world.copy_positions(now.positions);
    now.t = frame * fall.dt;
    if (std::find(fall.shown.begin(), fall.shown.end(), frame) != fall.shown.end())
      result.shown.push_back(now);
  };
  keep(0);
  for (std::uint32_t frame = 1; frame <= fall.frames && result.finite; ++frame) {
    const auto start = scenes::Clock::now();
    result.total += world.step(fall.dt);
    times.push_back(scenes::seconds_since(start));
    keep(frame);
    result.stretch = std::max(result.stretch, measure_stretch(scene, now.positions).max);
    result.last_depth = depth_in_ground(scene, now.positions);
    result.depth = std::max(result.depth, result.last_depth);
    result.finite = std::isfinite(result.stretch) && std::isfinite(result.depth);
  }
  for (const double each : times) result.mean_s += each / static_cast<double>(times.size());
  std::sort(times.begin(), times.end());
  result.median_s = times[times.size() / 2];
  result.worst_s = times.back();
  return result;
}

double growth(const FallResult& first, const FallResult& last) {
  return std::log(last.mean_s / first.mean_s) /
         std::log(static_cast<double>(last.rods) / static_cast<double>(first.rods));
}

}  // namespace plumb::tools
