// bench_queries measures what rays into a crowd of ropes and figures cost, beside looking at everything, and
// what it costs to follow a step. Every distance is checked against that of looking at everything.
#include <benchmark/benchmark.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <set>
#include <vector>

#include "plumb/plumb.hpp"
#include "scenes/basics/seeded.hpp"
#include "scenes/humanoid/humanoid.hpp"

namespace plumb::bench {
namespace {

constexpr double frame = 1.0 / 60;
constexpr std::uint32_t figures = 1000, ropes = 1000, links = 32, rays = 100000;
constexpr double rope_radius = 0.02;  // m
constexpr double field = 80;          // m, the side of the square that figures stand in

/// Hangs ropes of 3.2 m over the figures, turned to all sides, so that they swing.
Scene crowd_and_ropes() {
  Scene scene = scenes::make_crowd({.humanoids = figures, .hit = 0});
  scenes::Random random(1);
  for (std::uint32_t rope = 0; rope < ropes; ++rope) {
    const Vec3 anchor{random.between(0, field), 4, random.between(0, field)};
    const double turn = random.between(0, 2 * std::numbers::pi);
    for (std::uint32_t i = 0; i <= links; ++i) {
      const auto next = static_cast<std::uint32_t>(scene.particles.size());
      const double far = 0.1 * i;
      scene.particles.push_back(
          {.position = anchor + Vec3{0.6 * far * std::cos(turn), -0.8 * far, 0.6 * far * std::sin(turn)},
           .mass = 0.05,
           .fixed = i == 0});
      if (i > 0) scene.rods.push_back({.a = next - 1, .b = next});
    }
  }
  return scene;
}

/// Eyes of figures look everywhere.
std::vector<Ray> looks() {
  scenes::Random random(2);
  std::vector<Ray> out;
  for (std::uint32_t i = 0; i < rays; ++i) {
    const Vec3 eye{random.between(0, field), random.between(0.5, 3), random.between(0, field)};
    Vec3 look{};
    do {
      look = random.in_cube();
    } while (!(norm(look) > 0.1 && norm(look) < 1));
    out.push_back({.origin = eye, .direction = look});
  }
  return out;
}

/// Holds all that is asked about.
struct Stage {
  Scene scene = crowd_and_ropes();
  World world{scene, {.threads = 1}};
  Queries queries{scene, {.rod_radius = rope_radius}};
  std::vector<Ray> rays = looks();

  Stage() {
    for (int i = 0; i < 30; ++i) world.step(frame);
    queries.update(world);
  }
};
Stage& stage() {
  static Stage made;
  return made;
}

/// Returns how far (m) a ray goes to a ball.
double way_to_ball(const Ray& ray, Vec3 unit, Vec3 center, double radius) {
  const Vec3 arm = center - ray.origin;
  const double along = dot(arm, unit), room = radius * radius - dot(arm - along * unit, arm - along * unit);
  if (dot(arm, arm) <= radius * radius) return 0;
  return room < 0 || along < 0 ? INFINITY : along - std::sqrt(room);
}

/// Returns how far (m) a ray goes to a capsule: to its two balls, or to its side.
double way_to_capsule(const Ray& ray, Vec3 unit, Vec3 p, Vec3 q, double radius) {
  const double ends = std::min(way_to_ball(ray, unit, p, radius), way_to_ball(ray, unit, q, radius));
  const double length = norm(q - p);
  if (!(length > 0)) return ends;
  const Vec3 axis = (1 / length) * (q - p), from = ray.origin - p;
  const Vec3 flat = unit - dot(unit, axis) * axis, aside = from - dot(from, axis) * axis;
  const double a = dot(flat, flat), b = dot(aside, flat), c = dot(aside, aside) - radius * radius;
  const double height = dot(from, axis);
  if (c <= 0 && height >= 0 && height <= length) return 0;
  if (!(a > 0) || b * b < a * c) return ends;
  const double way = (-b - std::sqrt(b * b - a * c)) / a, at = height + way * dot(unit, axis);
  return way >= 0 && at >= 0 && at <= length ? std::min(ends, way) : ends;
}

/// Looks at everything.
class BruteForce {
 public:
  explicit BruteForce(const Stage& of) : scene_(of.scene), positions_(of.world.particle_count()) {
    of.world.copy_positions(positions_);
    std::set<std::set<std::uint32_t>> held;
    for (const Capsule& each : scene_.capsules) {
      lines_.push_back({position_of(each.a, positions_), position_of(each.b, positions_), each.radius});
      std::set<std::uint32_t> particles;
      for (const Point* const point : {&each.a, &each.b})
        for (std::size_t k = 0; k < 4; ++k)
          if (point->weights[k] != 0) particles.insert(point->particles[k]);
      held.insert(particles);
    }
    // Some rods of figures have no capsule either.
    for (const Rod& rod : scene_.rods)
      if (!held.contains({rod.a, rod.b}))
        lines_.push_back({positions_[rod.a], positions_[rod.b], rope_radius});
  }

  double cast(const Ray& ray) const {
    const Vec3 unit = (1 / norm(ray.direction)) * ray.direction;
    double nearest = INFINITY;
    for (const Line& line : lines_)
      nearest = std::min(nearest, way_to_capsule(ray, unit, line.p, line.q, line.radius));
    for (const Plane& plane : scene_.planes)
      if (const double down = -dot(plane.normal, unit); down > 0)
        nearest = std::min(nearest, (dot(plane.normal, ray.origin) - plane.offset) / down);
    return nearest;
  }
  std::size_t size() const { return lines_.size(); }

 private:
  struct Line {
    Vec3 p, q;
    double radius;
  };
  const Scene& scene_;
  std::vector<Vec3> positions_;
  std::vector<Line> lines_;
};

void time_a_ray(benchmark::State& state, std::size_t count) {
  state.counters["ray"] =
      benchmark::Counter(static_cast<double>(count),
                         benchmark::Counter::kIsIterationInvariantRate | benchmark::Counter::kInvert);
}

void cast_rays(benchmark::State& state) {
  const Stage& on = stage();
  std::vector<Hit> hits(on.rays.size());
  for (auto _ : state) on.queries.cast_rays(on.rays, hits);
  time_a_ray(state, hits.size());
  const BruteForce brute(on);
  double worst = 0;
  for (std::size_t i = 0; i < hits.size(); i += 1000) {
    const double distance = brute.cast(on.rays[i]);
    if (std::isfinite(distance) || std::isfinite(hits[i].distance))
      worst = std::max(worst, std::abs(distance - hits[i].distance));
  }
  state.counters["off_m"] = worst;
  state.counters["things"] = static_cast<double>(brute.size());
  state.counters["hit"] =
      static_cast<double>(std::count_if(hits.begin(), hits.end(), [](const Hit& hit) { return bool(hit); })) /
      static_cast<double>(hits.size());
}

void brute_force(benchmark::State& state) {
  const Stage& on = stage();
  const BruteForce brute(on);
  constexpr std::size_t some = 200;
  for (auto _ : state)
    for (std::size_t i = 0; i < some; ++i) benchmark::DoNotOptimize(brute.cast(on.rays[i]));
  time_a_ray(state, some);
}

void update(benchmark::State& state) {
  Stage& on = stage();
  for (auto _ : state) on.queries.update(on.world);
}

void build(benchmark::State& state) {
  const Stage& on = stage();
  for (auto _ : state) benchmark::DoNotOptimize(Queries(on.scene, {.rod_radius = rope_radius}));
}

/// Others may hold the processor for a while: the least of some repetitions is what it takes.
double least(const std::vector<double>& times) {
  return *std::min_element(times.begin(), times.end());
}

void in_milliseconds(benchmark::internal::Benchmark* of) {
  of->Unit(benchmark::kMillisecond)->UseRealTime()->ComputeStatistics("min", least);
}

BENCHMARK(cast_rays)->Apply(in_milliseconds);
BENCHMARK(brute_force)->Apply(in_milliseconds);
BENCHMARK(update)->Apply(in_milliseconds);
BENCHMARK(build)->Apply(in_milliseconds);

}  // namespace
}  // namespace plumb::bench

BENCHMARK_MAIN();
