#pragma once

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <numbers>
#include <vector>

#include "plumb/joints.hpp"
#include "plumb/plumb.hpp"
#include "scenes/humanoid/limbs.hpp"
#include "support/direct.hpp"

/// What tests of bodies, joints and contact share.
namespace plumb::test {

constexpr double frame = 1.0 / 60;  ///< s
constexpr double earth = 9.81;      ///< m/s², Scene::gravity
constexpr double degree = std::numbers::pi / 180;

/// Nothing falls asleep unless it is asked to.
inline Settings body_settings(std::uint32_t substeps = 1, bool sleep = false) {
  return {.method = Method::direct, .substeps = substeps, .sleep = sleep, .threads = 1};
}

constexpr Surface smooth{.friction = 0, .restitution = 0};

/// A ball as a single particle, which does not spin. Its particle.
inline std::uint32_t add_ball(Scene& scene, Vec3 position, double radius, double mass, Vec3 velocity = {},
                              Surface surface = smooth) {
  const auto particle = static_cast<std::uint32_t>(scene.particles.size());
  scene.particles.push_back(movable(position, mass, velocity));
  scene.capsules.push_back(
      {.a = point_at(particle), .b = point_at(particle), .radius = radius, .surface = surface});
  return particle;
}

/// A thin rod within a capsule, on two particles of its own. Its rod.
inline std::uint32_t add_capsule_rod(Scene& scene, Vec3 a, Vec3 b, double mass, double radius,
                                     Surface surface = smooth) {
  const auto particle = static_cast<std::uint32_t>(scene.particles.size());
  const auto rod = static_cast<std::uint32_t>(scene.rods.size());
  scene.particles.push_back(movable(a, 0));
  scene.particles.push_back(movable(b, 0));
  scene.rods.push_back({.a = particle, .b = particle + 1, .mass = mass});
  scene.capsules.push_back(
      {.a = point_at(particle), .b = point_at(particle + 1), .radius = radius, .surface = surface});
  return rod;
}

/// A body on four fixed particles.
inline std::uint32_t add_fixed_body(Scene& scene) {
  const auto first = static_cast<std::uint32_t>(scene.particles.size());
  for (const Vec3 at : {Vec3{0, 0, 0}, Vec3{1, 0, 0}, Vec3{0, 1, 0}, Vec3{0, 0, 1}})
    scene.particles.push_back(fixed(at));
  return add_body(scene, {first, first + 1, first + 2, first + 3}, solid_sphere(1, 1));
}

/// Sets the four particles of a body moving as `velocity` of its centre and `spin` (1/s) say.
inline void set_motion(Scene& scene, std::uint32_t body, Vec3 velocity, Vec3 spin) {
  const Body& it = scene.bodies[body];
  for (const std::uint32_t i : it.particles)
    scene.particles[i].velocity = velocity + cross(spin, scene.particles[i].position - it.center);
}

/// How a body turns, in 1/s, from its four particles: half the sum of g x w over its edges' velocities w, g
/// being the edges' reciprocal basis.
inline Vec3 spin_of(const World& world, const Body& body) {
  const auto edge = [&](int i) {
    return world.position(body.particles[i]) - world.position(body.particles[0]);
  };
  const Vec3 e[3] = {edge(1), edge(2), edge(3)};
  const double volume = dot(e[0], cross(e[1], e[2]));
  Vec3 twice{};
  for (int i = 0; i < 3; ++i)
    twice += cross((1 / volume) * cross(e[(i + 1) % 3], e[(i + 2) % 3]),
                   world.velocity(body.particles[i + 1]) - world.velocity(body.particles[0]));
  return 0.5 * twice;
}

/// Of the centre, if its particles have equal masses: those of four_points().
inline Vec3 velocity_of(const World& world, const Body& body) {
  Vec3 sum{};
  for (const std::uint32_t i : body.particles) sum += world.velocity(i);
  return 0.25 * sum;
}

inline Vec3 place_of(const World& world, const Point& point) {
  return scenes::place_of(point, positions_of(world));
}

/// Of the whole, with masses as they are.
inline Momentum momentum_of(const Scene& scene, const World& world) {
  return measure_momentum(scene, positions_of(world), velocities_of(world), MassModel::consistent);
}

/// How far the lowest capsule is below a plane, in m; negative: above all.
inline double deepest(const Scene& scene, const World& world) {
  const std::vector<Vec3> x = positions_of(world);
  double depth = -1e30;
  for (const Plane& plane : scene.planes)
    for (const Capsule& capsule : scene.capsules)
      for (const Point* end : {&capsule.a, &capsule.b})
        depth = std::max(depth, plane.offset - dot(plane.normal, scenes::place_of(*end, x)) + capsule.radius);
  return depth;
}

}  // namespace plumb::test
