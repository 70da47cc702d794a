#include "fall/measure.hpp"

#include <algorithm>
#include <cmath>

#include "scenes/basics/clock.hpp"
#include "scenes/runs/depth.hpp"
#include "scenes/spec.hpp"

namespace plumb::tools {
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
    result.last_depth = scenes::depth_in_ground(scene, now.positions);
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
