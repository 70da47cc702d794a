// A row of dominoes falls as fast on every kind of level ground, and in steps of every length.

#include <gtest/gtest.h>

#include <cmath>
#include <vector>

#include "support/boxes.hpp"

namespace plumb::PLUMB_TEST_FILE {
namespace {

constexpr int dominoes = 20;
constexpr double height = 0.5, width = 0.05, pitch = 0.2;

/// Dominoes along x, the first of which falls over its lower edge.
Scene row_on(const Scene& ground) {
  Scene scene = ground;
  for (int i = 0; i < dominoes; ++i)
    test::add_box(scene, {pitch * i - 2, height / 2, 0}, {width / 2, height / 2, 0.125}, 1,
                  {.friction = 0.3});
  const Body& first = scene.bodies[0];
  const Vec3 edge = first.center + Vec3{width / 2, -height / 2, 0};
  for (const std::uint32_t i : first.particles)
    scene.particles[i].velocity = cross(Vec3{0, 0, -2.5}, scene.particles[i].position - edge);
  return scene;
}

/// How fast the fall goes along the row, m/s: from the tenth domino to the last but one, each as it leans by
/// 0.2.
double speed_of_fall(const Scene& scene, double dt, std::uint32_t substeps) {
  constexpr double leaning = 0.2;
  World world(scene, test::body_settings(substeps));
  const auto lean = [&](std::uint32_t i) {
    const Vec3 middle = scene.bodies[i].center;
    const Vec3 up = test::place_of(world, point_on_body(scene, i, middle + Vec3{0, 1, 0})) -
                    test::place_of(world, point_on_body(scene, i, middle));
    return std::atan2(up.x, up.y);
  };
  std::vector<double> leans(dominoes), when(dominoes);
  while (when[dominoes - 2] == 0 && world.time() < 5) {
    EXPECT_EQ(world.step(dt).unsolved, 0u);
    for (std::uint32_t i = 0; i < dominoes; ++i) {
      const double now = lean(i);
      if (when[i] == 0 && now > leaning) when[i] = world.time() - dt * (now - leaning) / (now - leans[i]);
      leans[i] = now;
    }
  }
  return pitch * (dominoes - 2 - 10) / (when[dominoes - 2] - when[10]);
}

// 5 % is the bar; 0.5 % were seen from 1 to 64 substeps a frame. The row is slower than a wave that would be
// as high as a domino, sqrt(g H) = 2.2 m/s times two, and faster than half of that.
TEST(Dominoes, FallAtASpeedThatDoesNotDependOnTheStep) {
  const Scene scene = row_on(test::level_grounds({.friction = 0.8})[0].second);
  const double speed = speed_of_fall(scene, 1.0 / 60, 16);
  EXPECT_GT(speed, std::sqrt(test::earth * height));
  EXPECT_LT(speed, 2 * std::sqrt(test::earth * height));
  for (const std::uint32_t substeps : {1u, 2u, 4u})
    EXPECT_NEAR(speed_of_fall(scene, 1.0 / 60, substeps), speed, 0.05 * speed) << substeps;
  EXPECT_NEAR(speed_of_fall(scene, 1.0 / 240, 1), speed, 0.05 * speed);
}

// Boxes and triangles are as level as a plane, so that the row falls as fast as there, in the same steps.
TEST(Dominoes, FallOnMeshesAsOnPlanes) {
  const auto grounds = test::level_grounds({.friction = 0.8});
  const double speed = speed_of_fall(row_on(grounds[0].second), 1.0 / 60, 4);
  for (const auto& [name, ground] : grounds)
    EXPECT_NEAR(speed_of_fall(row_on(ground), 1.0 / 60, 4), speed, 0.05 * speed) << name;
}

}  // namespace
}  // namespace plumb::PLUMB_TEST_FILE
