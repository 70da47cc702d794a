// bench_reads measures what it costs to read where everything of a world is, by how it lies in memory. Each
// read is checked against that of each particle or body alone, and a plain copy says what memory takes.
#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstdio>
#include <cstring>
#include <string>
#include <vector>

#include "plumb/embedding/frames.hpp"
#include "plumb/joints.hpp"
#include "plumb/world.hpp"
#include "scenes/generators/generators.hpp"
#include "scenes/humanoid/humanoid.hpp"

namespace plumb::bench {
namespace {

constexpr double frame = 1.0 / 60;
constexpr int repeats = 300;

/// Returns the least and the median time (us) of many calls of f().
template <class F>
std::pair<double, double> time(F&& f) {
  std::vector<double> times;
  for (int i = 0; i < repeats; ++i) {
    const auto begin = std::chrono::steady_clock::now();
    f();
    times.push_back(
        std::chrono::duration<double, std::micro>(std::chrono::steady_clock::now() - begin).count());
  }
  std::sort(times.begin(), times.end());
  return {times.front(), times[times.size() / 2]};
}

void say(const std::string& what, std::size_t count, std::pair<double, double> times, bool is_right = true) {
  std::printf("| %s | %zu | %.1f | %.1f |%s\n", what.c_str(), count, times.first, times.second,
              is_right ? "" : " WRONG");
}

void read_particles(const std::string& name, const Scene& scene, Settings settings) {
  settings.threads = 1;
  World world(scene, settings);
  for (int i = 0; i < 3; ++i) world.step(frame);
  std::vector<Vec3> out(world.particle_count()), copy(out.size());
  const auto agrees = [&](auto&& one) {
    for (std::uint32_t i = 0; i < out.size(); ++i)
      if (out[i] != one(i)) return false;
    return true;
  };
  auto times = time([&] { world.copy_positions(out); });
  say(name + ": positions", out.size(), times, agrees([&](std::uint32_t i) { return world.position(i); }));
  times = time([&] { world.copy_velocities(out); });
  say(name + ": velocities", out.size(), times, agrees([&](std::uint32_t i) { return world.velocity(i); }));
  say(name + ": a plain copy", out.size(), time([&] {
        std::memcpy(copy.data(), out.data(), out.size() * sizeof(Vec3));
        asm volatile("" : : "r"(copy.data()) : "memory");
      }));
  Frames frames;
  say(name + ": frames", out.size(), time([&] { frames.update(world); }), frames.moved().empty());
  std::vector<float> vertices(8 * out.size());
  times = time([&] { frames.copy({vertices.data(), out.size(), 32}, 0.4); });
  const bool is_near = std::abs(vertices[8] - static_cast<float>(world.position(1).x)) < 1e-6;
  say(name + ": 0.4 of the way, float", out.size(), times, is_near);
}

void read_bodies(const std::string& name, const Scene& scene, Settings settings) {
  settings.threads = 1;
  World world(scene, settings);
  for (int i = 0; i < 3; ++i) world.step(frame);
  std::vector<Pose> poses(world.body_count());
  std::vector<BodyMotion> motions(world.body_count());
  auto times = time([&] { world.copy_poses(poses); });
  bool is_right = true;
  for (std::uint32_t i = 0; i < poses.size(); ++i) is_right = is_right && poses[i] == world.pose(i);
  say(name + ": poses", poses.size(), times, is_right);
  times = time([&] { world.copy_motions(motions); });
  is_right = true;
  for (std::uint32_t i = 0; i < motions.size(); ++i) is_right = is_right && motions[i] == world.motion(i);
  say(name + ": motions", motions.size(), times, is_right);
}

/// Throws bodies that turn, each alone.
Scene thrown_bodies(std::uint32_t count) {
  Scene scene;
  for (std::uint32_t i = 0; i < count; ++i) {
    const Vec3 at{0.5 * i, 0, 0}, spin{1, 2 + 0.001 * i, 3};
    const std::uint32_t body =
        add_body(scene, {.mass = 1, .center = at, .inertia = {.xx = 0.002, .yy = 0.0025, .zz = 0.003}});
    for (const std::uint32_t particle : scene.bodies[body].particles)
      scene.particles[particle].velocity = cross(spin, scene.particles[particle].position - at);
  }
  return scene;
}

}  // namespace
}  // namespace plumb::bench

int main() {
  using namespace plumb;
  std::puts("| read | of | least, us | median, us |\n|---|---|---|---|");
  for (const Method method : {Method::direct, Method::relax})
    for (const Precision precision : {Precision::double_, Precision::single}) {
      const Settings settings{.method = method, .precision = precision};
      const std::string how =
          ", " + std::string(to_string(method)) + ", " + std::string(to_string(precision));
      bench::read_particles("ropes" + how, scenes::make_ensemble({.chains = 6250, .links = 16}), settings);
      bench::read_particles("a chain" + how, scenes::make_chain(100000, 0.1, 1), settings);
      bench::read_particles("a net" + how, scenes::make_net(316, 316), settings);
    }
  bench::read_particles("a graph, relax", scenes::make_graph({.particles = 100000, .degree = 5}),
                        {.method = Method::relax});
  bench::read_particles("figures", scenes::make_crowd({.humanoids = 1000, .hit = 1000}), {});
  bench::read_bodies("bodies", bench::thrown_bodies(10000), {});
  bench::read_bodies("bodies, relax", bench::thrown_bodies(10000), {.method = Method::relax});
  bench::read_bodies("figures", scenes::make_crowd({.humanoids = 1000, .hit = 1000}), {});
}
