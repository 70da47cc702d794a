#include "thesis/springs.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "plumb/reference/springs.hpp"
#include "plumb/world.hpp"
#include "scenes/basics/clock.hpp"

namespace plumb::tools {
namespace {

/// Whether a tug at the anchor leaves vibrations that grow. Without gravity nothing swings. The tug is so
/// small that what grows is not what springs do when they are far apart.
bool grows(Scene scene, Settings settings, double step) {
  scene.gravity = {};
  World world(scene, settings);
  world.move_anchor(0, scene.particles[0].position + Vec3{1e-9, 1e-9, 1e-9});
  // With a per cent of stiffness beyond its limit, forward Euler grows by some 1e-4 a step.
  constexpr int first_steps = 20, steps = 50000;
  double start = 0;
  for (int i = 0; i < steps; ++i) {
    const StepReport report = world.step(step);
    if (i < first_steps) start = std::max(start, report.largest_gap);
    if (report.frozen_islands > 0 || !(report.largest_gap <= 100 * std::max(start, 1e-9))) return true;
  }
  return false;
}

/// Returns the stiffness at which `stable` ceases to hold. It holds at `low` and not at `high`.
template <class Stable>
double bisect(double low, double high, Stable stable) {
  while (high / low > 1.001) {
    const double middle = std::sqrt(low * high);
    (stable(middle) ? low : high) = middle;
  }
  return std::sqrt(low * high);
}

/// Returns the scene turned so that its +x points down.
Scene hung(Scene scene) {
  const Vec3 root = scene.particles.front().position;
  for (Particle& particle : scene.particles) {
    const Vec3 d = particle.position - root;
    particle.position = root + Vec3{d.y, -d.x, d.z};
  }
  return scene;
}

/// Returns the weight of a rod as a rigid body, in N. The rods that end at a particle share its mass. A fixed
/// end counts as heavy as the other, so that the rod has something to turn by.
double weight(const Scene& scene, std::size_t rod) {
  const Rod& r = scene.rods[rod];
  const auto share = [&](std::uint32_t particle, std::uint32_t other) {
    const std::uint32_t from = scene.particles[particle].fixed ? other : particle;
    const auto rods_at = std::count_if(scene.rods.begin(), scene.rods.end(),
                                       [from](const Rod& at) { return at.a == from || at.b == from; });
    return scene.particles[from].mass / static_cast<double>(rods_at);
  };
  return norm(scene.gravity) * (r.mass + share(r.a, r.b) + share(r.b, r.a));
}

}  // namespace

Settings spring_settings(Integrator integrator, double stiffness, std::uint32_t substeps) {
  Settings settings{.method = Method::springs, .substeps = substeps, .integrator = integrator};
  settings.springs.stiffness = stiffness;
  settings.threads = 1;
  return settings;
}

SpringLimit find_spring_limit(const Scene& scene, Integrator integrator, double step) {
  const auto settings = [&](double stiffness) { return spring_settings(integrator, stiffness); };
  SpringLimit out;
  out.predicted = bisect(1e-6, 1e12, [&](double stiffness) {
    return spring_stability(scene, settings(stiffness)).largest_step >= step;
  });
  out.found = bisect(out.predicted / 16, out.predicted * 16,
                     [&](double stiffness) { return !grows(scene, settings(stiffness), step); });
  return out;
}

HangingGaps measure_hanging_gaps(const Scene& scene, double stiffness) {
  const Scene down = hung(scene);
  Settings settings = spring_settings(Integrator::implicit_euler, stiffness);
  settings.springs.damping_ratio = 1;
  HangingGaps out;
  StepReport last;
  World world(down, settings);
  for (int frame = 0; frame < 600; ++frame) last = world.step(frame_length);
  out.largest = last.largest_gap;
  out.rms = last.rms_gap;
  for (std::size_t rod = 0; rod < down.rods.size(); ++rod) out.top_load += weight(down, rod) / stiffness;
  out.bottom_load = weight(down, down.rods.size() - 1) / stiffness;

  settings.springs.model = SpringModel::particles;
  settings.mass = MassModel::lumped;
  World particles(down, settings);
  for (int frame = 0; frame < 600; ++frame) particles.step(frame_length);
  std::vector<Vec3> positions(particles.particle_count());
  particles.copy_positions(positions);
  out.widest = measure_stretch(down, positions).max_rod;
  return out;
}

MovingGaps measure_moving_gaps(const Scene& scene, const Settings& settings) {
  World world(scene, settings);
  MovingGaps out;
  double squares = 0;
  constexpr int frames = 60;
  for (int frame = 0; frame < frames; ++frame) {
    const StepReport report = world.step(frame_length);
    out.largest = std::max(out.largest, report.largest_gap);
    squares += report.rms_gap * report.rms_gap;
  }
  out.rms = std::sqrt(squares / frames);
  return out;
}

double frames_per_second(const Scene& scene, const Settings& settings, double step) {
  const auto frames = static_cast<int>(std::lround(1 / step));
  double least = std::numeric_limits<double>::infinity(), spent = 0;
  for (int run = 0; run < 200 && spent < 0.05; ++run) {
    World world(scene, settings);
    StepReport total;
    const auto start = scenes::Clock::now();
    for (int frame = 0; frame < frames; ++frame) total += world.step(step);
    const double s = scenes::seconds_since(start);
    if (total.frozen_islands > 0) return std::numeric_limits<double>::quiet_NaN();
    least = std::min(least, s / frames);
    spent += s;
  }
  return 1 / least;
}

}  // namespace plumb::tools
