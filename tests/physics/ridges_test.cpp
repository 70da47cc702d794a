// Hulls that are thrown on open meshes with sharp ridges, which have no inside to push out of.

#include <gtest/gtest.h>

#include <cmath>
#include <cstdint>
#include <random>

#include "plumb/plumb.hpp"
#include "support/bodies.hpp"
#include "support/boxes.hpp"
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

/// Adds a tetrahedron with a rounding of `radius` (m), which spins at random.
void add_tetrahedron(Scene& scene, Vec3 middle, double radius, std::mt19937& random) {
  std::uniform_real_distribution<double> any_spin(-8, 8);
  const std::uint32_t body = test::add_tetrahedron(scene, middle, 0.1, random);
  scene.hulls.back().radius = radius;
  test::set_motion(scene, body, {1, 0, 0}, {any_spin(random), any_spin(random), any_spin(random)});
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
