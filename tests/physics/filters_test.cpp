// Filters say what may touch what, in every phase of contact.

#include <gtest/gtest.h>

#include "contact/clusters.hpp"
#include "contact/linkage/linkage_bounds.hpp"
#include "plumb/shapes/queries.hpp"
#include "support/bodies.hpp"
#include "support/linkages.hpp"
#include "support/refusals.hpp"

namespace plumb::PLUMB_TEST_FILE {
namespace {

using test::frame;

/// A ball of 0.1 m at a height, with a filter.
std::uint32_t add_ball(Scene& scene, double x, double height, Filter filter) {
  const std::uint32_t ball = test::add_ball(scene, {x, height, 0}, 0.1, 1);
  scene.capsules.back().filter = filter;
  return ball;
}

// Balls over a plane, a box on it, and a resting ball: each lies on the highest thing that it may touch.
TEST(Filters, LetThingsFallThroughWhatTheyDoNotTouch) {
  constexpr std::uint32_t floor = 1, furniture = 2, balls = 4;
  Scene scene;
  scene.planes.push_back({.filter = {.category = floor}});
  scene.boxes.push_back({.center = {0, 0.5, 0}, .half_size = {9, 0.5, 9}, .filter = {.category = furniture}});
  const std::uint32_t usual = add_ball(scene, 0, 1.5, {.category = balls, .mask = floor | furniture | balls});
  const std::uint32_t on_top =
      add_ball(scene, 0, 2.5, {.category = balls, .mask = floor | furniture | balls});
  const std::uint32_t through_box = add_ball(scene, 2, 1.5, {.category = balls, .mask = floor});
  const std::uint32_t through_all = add_ball(scene, 4, 1.5, {.category = balls, .mask = balls});
  const std::uint32_t through_balls = add_ball(scene, 0, 3.5, {.category = 8, .mask = furniture});
  World world(scene, test::body_settings(2));
  test::run(world, frame, 120);
  EXPECT_NEAR(world.position(usual).y, 1.1, 1e-3);
  EXPECT_NEAR(world.position(on_top).y, 1.3, 2e-3);
  EXPECT_NEAR(world.position(through_box).y, 0.1, 1e-3);
  EXPECT_NEAR(world.position(through_all).y, 1.5 - test::earth * 2, 1e-9);
  EXPECT_NEAR(world.position(through_balls).y, 1.1, 1e-3);
}

/// A scene with ground of one kind below the origin, 1 m high, in a category of its own.
Scene ground_of(std::size_t kind) {
  constexpr Filter furniture{.category = 2};
  Scene scene;
  std::vector<Vec3> corners;
  for (const double x : {-9.0, 9.0})
    for (const double y : {0.0, 1.0})
      for (const double z : {-9.0, 9.0}) corners.push_back({x, y, z});
  switch (kind) {
    case 0:
      scene.ground_capsules = {{.a = {-9, 0, 0}, .b = {9, 0, 0}, .radius = 1, .filter = furniture}};
      break;
    case 1:
      scene.ground_hulls = {{.points = corners, .filter = furniture}};
      break;
    case 2:
      scene.meshes = {{.vertices = {corners[2], corners[3], corners[6], corners[7]},
                       .triangles = {{0, 1, 2}, {1, 3, 2}},
                       .filter = furniture}};
      break;
    default:
      scene.height_fields = {{.corner = {-9, 1, -9},
                              .cell_x = 18,
                              .cell_z = 18,
                              .columns = 2,
                              .heights = {0, 0, 0, 0},
                              .filter = furniture}};
  }
  return scene;
}

// Each ground holds a ball and a cube that may touch it, and lets those fall that may not. Rays see it so.
TEST(Filters, OfGroundOfEveryKindAndOfHulls) {
  for (const Method method : {Method::automatic, Method::relax})
    for (std::size_t kind = 0; kind < 4; ++kind) {
      Scene scene = ground_of(kind);
      const std::uint32_t held = add_ball(scene, 0, 1.3, {});
      const std::uint32_t falls = add_ball(scene, 2, 1.3, {.mask = 1});
      for (const double x : {4.0, 6.0}) {
        MassProperties cube = solid_box(1, {0.2, 0.2, 0.2});
        cube.center = {x, 1.3, 0};
        scene.hulls.push_back(box_on_body(
            add_body(scene, cube),
            {.center = cube.center, .half_size = {0.1, 0.1, 0.1}, .filter = {.mask = x > 5 ? 1u : 3u}}));
      }
      World world(scene, {.method = method, .substeps = 4});
      test::run(world, frame, 60);
      EXPECT_NEAR(world.position(held).y, 1.1, 5e-3) << kind;
      EXPECT_LT(world.position(falls).y, 0) << kind;
      const auto height = [&](std::size_t body) { return world.position(scene.bodies[body].particles[0]).y; };
      EXPECT_GT(height(0), 1) << kind;
      EXPECT_LT(height(1), 0) << kind;
      const Queries queries(scene);
      const Ray down{.origin = {-3, 3, 0}, .direction = {0, -1, 0}, .length = 5};
      EXPECT_TRUE(queries.cast_ray(down)) << kind;
      EXPECT_FALSE(queries.cast_ray(down, {.filter = {.mask = 1}})) << kind;
    }
}

TEST(Filters, OfAnIslandAreForCapsules) {
  for (std::size_t kind = 0; kind < 4; ++kind) {
    Scene scene = ground_of(kind);
    const auto refused = [&](auto& shapes) {
      if (shapes.empty()) return false;
      shapes[0].filter.own_island = true;
      return test::refusal([&] { validate(scene); }).find("own_island is for capsules") != std::string::npos;
    };
    EXPECT_TRUE(refused(scene.ground_capsules) || refused(scene.ground_hulls) || refused(scene.meshes) ||
                refused(scene.height_fields))
        << kind;
  }
}

// Where two shapes end at one particle, the larger end counts, but only of those that touch the same.
TEST(Filters, OfShapesThatShareAParticleAreKeptApart) {
  Scene scene;
  scene.planes.push_back({.filter = {.category = 2}});
  const std::uint32_t ball = add_ball(scene, 0, 1, {});
  scene.capsules.push_back(scene.capsules[0]);
  scene.capsules[1].radius = 0.3;
  scene.capsules[1].filter.mask = 1;
  World world(scene, test::body_settings(2));
  test::run(world, frame, 120);
  EXPECT_NEAR(world.position(ball).y, 0.1, 1e-3);
}

std::uint32_t clusters_of(const Scene& scene) {
  test::Linkages islands(scene);
  detail::Clusters clusters;
  clusters.start(islands.states, 0);
  detail::Team team(1);
  clusters.form(team, [&](const detail::LinkageState& state) {
    return detail::bounds_of(*state.linkage, state.x, 0.5);
  });
  return clusters.count();
}

// The broad phase does not put islands together that cannot touch.
TEST(Filters, KeepIslandsOutOfClusters) {
  Scene scene;
  for (int i = 0; i < 4; ++i) add_ball(scene, 0.3 * i, 0, {.group = -1});
  EXPECT_EQ(clusters_of(scene), 4u);
  scene.capsules[2].filter = {};
  EXPECT_EQ(clusters_of(scene), 1u) << "all may touch the third";
  scene.capsules[2].filter = {.category = 2};
  scene.capsules[0].filter.mask = 1;
  EXPECT_EQ(clusters_of(scene), 2u) << "but the first";
}

// A sleeper is not woken by what falls through it.
TEST(Filters, LetSleepersSleep) {
  Scene scene;
  scene.planes.push_back({});
  const std::uint32_t sleeper = add_ball(scene, 0, 0.1, {.group = -1});
  scene.particles[sleeper].asleep = true;
  add_ball(scene, 0, 1, {.group = -1});
  World world(scene, test::body_settings(1, true));
  std::uint32_t most = 0;
  for (int i = 0; i < 60; ++i) most = std::max(most, world.step(frame).awake_islands);
  EXPECT_EQ(most, 1u);
}

}  // namespace
}  // namespace plumb::PLUMB_TEST_FILE
