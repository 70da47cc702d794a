// What plumb fall measures and draws.

#include <gtest/gtest.h>

#include <cmath>

#include "fall/measure.hpp"
#include "fall/pictures.hpp"
#include "fall/view.hpp"
#include "scenes/runs/depth.hpp"
#include "scenes/spec.hpp"
#include "support/bodies.hpp"

namespace plumb::tools::PLUMB_TEST_FILE {
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
  EXPECT_GT(result.total.contact_points, 0u);
  EXPECT_LE(result.median_s, result.worst_s);
  EXPECT_GE(result.depth, result.last_depth);
}

TEST(Fall, DrawsEveryCapsuleAtEveryInstant) {
  const Scene scene = scenes::load_scene("drape:size=4");
  const Fall fall{.scene = "drape:size=4", .settings = {.threads = 1}, .frames = 5, .shown = {0, 5}};
  const std::string svg = draw_fall(scene, run_fall(fall).shown);
  std::size_t times = 0, strokes = 0;
  for (std::size_t at = 0; (at = svg.find("t = ", at)) != std::string::npos; ++at) ++times;
  for (std::size_t at = 0; (at = svg.find("class=\"shape\"", at)) != std::string::npos; ++at) ++strokes;
  EXPECT_EQ(times, 2u);
  EXPECT_EQ(strokes, 2 * scene.capsules.size());
  EXPECT_NE(svg.find("fill=\"#e4e4e4\""), std::string::npos) << "the box's upper face";
}

TEST(Fall, DepthInRoundGroundAndOfCorners) {
  Scene scene;
  scene.particles = {test::movable({0.3, 0.4, 0}, 1)};
  scene.capsules = {{.a = point_at(0), .b = point_at(0), .radius = 0.2}};
  scene.ground_capsules = {{.a = {-1, 0, 0}, .b = {0, 0, 0}, .radius = 0.4}};
  // 0.5 m from the capsule's end.
  EXPECT_NEAR(scenes::depth_in_ground(scene, {{scene.particles[0].position}}), 0.1, 1e-15);
  scene.capsules.clear();
  scene.ground_capsules.clear();
  scene.planes = {{.offset = 0.25}};
  const std::uint32_t body = add_body(scene, solid_box(1, {1, 1, 1}));
  scene.hulls = {box_on_body(body, {.half_size = {0.5, 0.5, 0.5}})};
  std::vector<Vec3> at;
  for (const Particle& each : scene.particles) at.push_back(each.position + Vec3{0, 0.5, 0});
  EXPECT_NEAR(scenes::depth_in_ground(scene, at), 0.25, 1e-12);
}

// The eye is above, in front and to the right: a place behind and below a solid is hidden.
TEST(Fall, SolidsHideWhatIsBehindThem) {
  Scene scene;
  EXPECT_FALSE(is_hidden(scene, {0, 0, -2}));
  scene.ground_capsules = {{.a = {0, 0, 0}, .b = {0, 0, 0}, .radius = 1}};
  EXPECT_TRUE(is_hidden(scene, {-0.7, -0.5, -1.2}));
  EXPECT_FALSE(is_hidden(scene, {0.7, 0.5, 1.2}));
  EXPECT_FALSE(is_hidden(scene, {0, 1.1, 0}));
  scene.ground_capsules.clear();
  scene.boxes = {{.half_size = {1, 1, 1}}};
  EXPECT_TRUE(is_hidden(scene, {-0.7, -0.5, -1.2}));
  EXPECT_FALSE(is_hidden(scene, {0.7, 0.5, 1.2}));
  EXPECT_FALSE(is_hidden(scene, {0, 1.1, 0}));
}

}  // namespace
}  // namespace plumb::tools::PLUMB_TEST_FILE
