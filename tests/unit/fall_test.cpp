// What plumb fall measures and draws.

#include <gtest/gtest.h>

#include <cmath>

#include "fall/measure.hpp"
#include "fall/pictures.hpp"
#include "scenes/runs/depth.hpp"
#include "scenes/spec.hpp"
#include "support/bodies.hpp"

namespace plumb::tools {
namespace {

TEST(Fall, DepthIsThatOfTheDeepestEnd) {
  Scene scene;
  scene.particles = {test::movable({0, 0.03, 0}, 1), test::movable({1, 0.09, 0}, 1)};
  scene.rods = {{.a = 0, .b = 1}};
  scene.capsules = {{.a = point_at(0), .b = point_at(1), .radius = 0.05}};
  scene.planes = {{}};
  const std::vector<Vec3> at = {scene.particles[0].position, scene.particles[1].position};
  EXPECT_NEAR(scenes::depth_in_ground(scene, at), 0.02, 1e-15);
  // A box turned by 45° about z, whose edge is at x = 1 and 5 cm above the second end.
  const double half = std::acos(-1.0) / 8;
  scene.boxes = {{.center = {1, 0.14 - std::sqrt(2.0), 0},
                  .half_size = {1, 1, 1},
                  .orientation = {std::cos(half), 0, 0, std::sin(half)}}};
  EXPECT_NEAR(scenes::depth_in_ground(scene, at), 0.05 + 0.05 / std::sqrt(2.0), 1e-12);
  // Outside, and nearest to its lower face.
  scene.boxes = {{.center = {1, 0.62, 0}, .half_size = {0.5, 0.5, 0.5}}};
  EXPECT_NEAR(scenes::depth_in_ground(scene, at), 0.05 - 0.03, 1e-12);
}

TEST(Fall, GrowthIsTheExponentOfTime) {
  EXPECT_NEAR(growth({.rods = 100, .mean_s = 1e-3}, {.rods = 10000, .mean_s = 0.1}), 1, 1e-12);
  EXPECT_NEAR(growth({.rods = 100, .mean_s = 1e-3}, {.rods = 1000, .mean_s = 0.1}), 2, 1e-12);
}

TEST(Fall, KeepsTheInstantsThatAreShown) {
  const FallResult result =
      run_fall({.scene = "rope:links=10", .settings = {.threads = 1}, .frames = 30, .shown = {0, 10, 30}});
  ASSERT_EQ(result.shown.size(), 3u);
  EXPECT_EQ(result.shown[1].t, 10.0 / 60);
  EXPECT_GT(result.shown[0].positions[0].y, result.shown[2].positions[0].y);
  EXPECT_EQ(result.rods, 10u);
  EXPECT_GT(result.total.contacts, 0u);
  EXPECT_LE(result.median_s, result.worst_s);
  EXPECT_GE(result.depth, result.last_depth);
}

TEST(Fall, DrawsEveryCapsuleAtEveryInstant) {
  const Scene scene = scenes::load_scene("drape:size=4");
  const Fall fall{.scene = "drape:size=4", .settings = {.threads = 1}, .frames = 5, .shown = {0, 5}};
  const std::string svg = draw_fall(scene, run_fall(fall).shown);
  std::size_t times = 0, strokes = 0;
  for (std::size_t at = 0; (at = svg.find("t = ", at)) != std::string::npos; ++at) ++times;
  for (std::size_t at = 0; (at = svg.find("stroke=\"#1f5fa8\"", at)) != std::string::npos; ++at) ++strokes;
  EXPECT_EQ(times, 2u);
  EXPECT_EQ(strokes, 2 * scene.capsules.size());
  EXPECT_NE(svg.find("fill=\"#e4e4e4\""), std::string::npos) << "the box's upper face";
}

}  // namespace
}  // namespace plumb::tools
