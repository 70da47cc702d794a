// Hulls that are thrown on open meshes with sharp ridges, which have no inside to push out of.

#include <gtest/gtest.h>

#include <cmath>
#include <cstdint>
#include <random>

#include "plumb/plumb.hpp"
#include "support/bodies.hpp"
#include "support/meshes.hpp"

namespace plumb::PLUMB_TEST_FILE {
namespace {

using test::frame;

constexpr double ridge = 0.2, half_width = 0.15;  // m

/// A landscape of ridges along z, one every 0.3 m.
Scene ridges() {
  const auto height = [](double x, double) {
    return std::abs(std::remainder(x, 2 * half_width)) > 0.5 * half_width ? ridge : 0.0;
  };
  const test::Mesh mesh = test::landscape(50, half_width, height);
  Scene scene;
  scene.meshes.push_back({mesh.vertices, mesh.triangles, false, {}});
  return scene;
}

/// Returns the height (m) of that landscape.
double height_at(double x) {
  return ridge / half_width * std::abs(std::remainder(x, 2 * half_width));
}

/// Adds a regular tetrahedron with a rounding of `radius` (m), turned and spinning at random, whose corners
/// are 0.1 sqrt(3) m from its middle.
std::uint32_t add_tetrahedron(Scene& scene, Vec3 middle, double radius, std::mt19937& random) {
  std::normal_distribution<double> normal;
  std::uniform_real_distribution<double> any_spin(-8, 8);
  const auto any = [&] { return Vec3{normal(random), normal(random), normal(random)}; };
  const auto unit = [](Vec3 v) { return (1 / norm(v)) * v; };
  const Vec3 u = unit(any()), v = unit(cross(u, any())), w = cross(u, v);
  constexpr double size = 0.1, inertia = 0.4 * size * size;  // of 1 kg
  const std::uint32_t body = add_body(
      scene, {.mass = 1, .center = middle, .inertia = {.xx = inertia, .yy = inertia, .zz = inertia}});
  Hull hull{.body = body, .radius = radius};
  for (const Vec3 at : {Vec3{1, 1, 1}, Vec3{1, -1, -1}, Vec3{-1, 1, -1}, Vec3{-1, -1, 1}})
    hull.points.push_back(middle + size * (at.x * u + at.y * v + at.z * w));
  scene.hulls.push_back(hull);
  test::set_motion(scene, body, {1, 0, 0}, {any_spin(random), any_spin(random), any_spin(random)});
  return body;
}

/// Counts those of 12 tetrahedra whose middle is below the landscape in the end.
int count_through(double radius, const Settings& settings, std::uint32_t seed) {
  std::mt19937 random(seed);
  Scene scene = ridges();
  for (int i = 0; i < 12; ++i)
    add_tetrahedron(scene, {0.4 * (i % 4) - 0.8, 0.7 + 0.05 * i, 0.45 * (i / 4) - 0.45}, radius, random);
  World world(scene, settings);
  for (int i = 0; i < 180; ++i) world.step(frame);
  int out = 0;
  for (std::uint32_t body = 0; body < 12; ++body) {
    const Vec3 at = world.pose(body).position;
    out += at.y < height_at(at.x) - 0.05 ? 1 : 0;
  }
  return out;
}

// A ridge that comes into a hull pushes it up, though it does so beside the sharp edge that it is kept off.
// Before, that edge was let go then, and up to a fifth of such hulls fell through.
TEST(Ridges, OfOpenMeshesHoldHullsWithTips) {
  for (const Method method : {Method::automatic, Method::relax})
    for (const std::uint32_t substeps : {1u, 4u})
      for (const double radius : {0.005, 0.02})
        for (const std::uint32_t seed : {0u, 1u, 2u, 3u})
          EXPECT_EQ(count_through(radius, {.method = method, .substeps = substeps, .threads = 1}, seed), 0)
              << to_string(method) << ", substeps " << substeps << ", radius " << radius << ", seed " << seed;
}

}  // namespace
}  // namespace plumb::PLUMB_TEST_FILE
