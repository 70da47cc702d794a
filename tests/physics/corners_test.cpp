// Hulls that are thrown into corners between solids that are walls together, and lie in holes between them.

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <random>
#include <vector>

#include "plumb/plumb.hpp"
#include "support/bodies.hpp"
#include "support/boxes.hpp"
#include "support/worlds.hpp"

namespace plumb::PLUMB_TEST_FILE {
namespace {

using test::frame;

constexpr Surface slippery{.friction = 0.1};

void add_wall(Scene& scene, Vec3 low, Vec3 high) {
  scene.boxes.push_back({.center = 0.5 * (low + high), .half_size = 0.5 * (high - low), .surface = slippery});
}

/// Adds a slippery tetrahedron. Returns its body.
std::uint32_t add_tetrahedron(Scene& scene, Vec3 middle, std::mt19937& random) {
  const std::uint32_t body = test::add_tetrahedron(scene, middle, 0.13, random);
  scene.hulls.back().surface = slippery;
  return body;
}

/// Follows where corners of a hull are by where its body's particles are.
class Corners {
 public:
  Corners(const Scene& scene, std::uint32_t body) {
    for (const Vec3 at : scene.hulls.back().points) corners_.push_back(point_on_body(scene, body, at));
  }
  template <class F>
  double deepest(const World& world, F&& depth) const {
    double most = -1;
    for (const Point& each : corners_)
      most = std::max(most, depth(scenes::place_of(each, test::positions_of(world))));
    return most;
  }

 private:
  std::vector<Point> corners_;
};

// A tip that is in both walls of a corner leaves both by their faces in the room. Before, each wall took its
// face in the other for none, and pushed out of its bottom 1 m away: up to 0.3 m deep, and 500 N s a step.
TEST(Corners, BetweenWallsKeepHullsOut) {
  for (const bool overlap : {true, false})
    for (const Method method : {Method::automatic, Method::relax}) {
      std::mt19937 random(0);
      int deep = 0;
      for (int run = 0; run < 12; ++run) {
        SCOPED_TRACE(testing::Message() << to_string(method) << " overlap " << overlap << " run " << run);
        Scene scene;
        scene.planes.push_back({.surface = slippery});
        add_wall(scene, {0.5, -1, -3}, {1.5, 3, 3});
        add_wall(scene, {-3, -1, 0.5}, {overlap ? 3 : 0.5, 3, 1.5});
        const std::uint32_t body = add_tetrahedron(scene, {-0.1, 0.35, -0.1}, random);
        const double angle = std::uniform_real_distribution<double>(0.3, 1.25)(random);
        test::set_motion(scene, body, {2 * std::cos(angle), 0, 2 * std::sin(angle)}, {});
        const Corners corners(scene, body);
        World world(scene, {.method = method, .threads = 1});
        const auto depth = [](Vec3 at) { return std::max({-at.y, at.x - 0.5, at.z - 0.5}); };
        double most = 0;
        for (int i = 0; i < 180; ++i) {
          world.step(frame);
          most = std::max(most, corners.deepest(world, depth));
        }
        deep += most > 0.01 ? 1 : 0;
        EXPECT_LT(corners.deepest(world, depth), overlap ? 2e-3 : 0.02);
        EXPECT_LT(most, 0.03);
      }
      EXPECT_LE(deep, overlap ? 0 : 2);
    }
}

// A peg of 0.2 m lies in a hole between four walls that overlap in its corners, with a play of 0.5 mm.
// Before, a relaxed one was pushed 0.39 m into a wall, and slept there.
TEST(Corners, OfAHoleHoldAPeg) {
  for (const Method method : {Method::automatic, Method::relax}) {
    SCOPED_TRACE(to_string(method));
    constexpr double half = 0.1, wide = half + 5e-4;
    Scene scene;
    add_wall(scene, {wide, -1, -2}, {2, 0, 2});
    add_wall(scene, {-2, -1, -2}, {-wide, 0, 2});
    add_wall(scene, {-2, -1, wide}, {2, 0, 2});
    add_wall(scene, {-2, -1, -2}, {2, 0, -wide});
    add_wall(scene, {-2, -2, -2}, {2, -1, 2});
    MassProperties peg = solid_box(2, {2 * half, 0.6, 2 * half});
    peg.center = {0, -0.1, 0};
    const std::uint32_t body = add_body(scene, peg);
    scene.hulls.push_back(box_on_body(body, {.center = peg.center, .half_size = {half, 0.3, half}}));
    const Corners corners(scene, body);
    World world(scene, {.method = method, .threads = 1});
    const auto depth = [](Vec3 at) {
      return std::max({-1 - at.y, std::abs(at.x) - wide, std::abs(at.z) - wide});
    };
    for (int i = 0; i < 120; ++i) {
      world.step(frame);
      ASSERT_LT(corners.deepest(world, depth), 2e-3) << i;
    }
    EXPECT_NEAR(world.pose(body).position.y, -0.7, 2e-3) << "it lies on the bottom";
  }
}

// A tip slides over a plane or a landscape at a wall that stands on it. Before, the wall's bottom, which lies
// in the floor, was the nearest way out: tips of relaxed hulls came 0.2 m deep, and slept there.
TEST(Corners, UnderAWallOnAFloorKeepHullsOut) {
  for (const bool is_plane : {true, false})
    for (const Method method : {Method::automatic, Method::relax})
      for (const std::uint32_t substeps : {1u, 4u}) {
        SCOPED_TRACE(testing::Message() << to_string(method) << substeps << (is_plane ? " plane" : " field"));
        Scene scene;
        if (is_plane)
          scene.planes.push_back({.surface = slippery});
        else
          scene.height_fields.push_back({.corner = {-4, 0, -4},
                                         .cell_x = 0.5,
                                         .cell_z = 0.5,
                                         .columns = 17,
                                         .heights = std::vector<double>(289, 0),
                                         .surface = slippery});
        add_wall(scene, {0.5, 0, -3}, {2.5, 2, 3});
        const Vec3 middle{0, 0.07, 0};
        constexpr double inertia = 5.9e-3;  // to 1 % about every axis
        const std::uint32_t body = add_body(
            scene, {.mass = 1, .center = middle, .inertia = {.xx = inertia, .yy = inertia, .zz = inertia}});
        scene.hulls.push_back({.body = body,
                               .points = {{0.2, 0, 0}, {-0.1, 0, 0.17}, {-0.1, 0, -0.17}, {0, 0.28, 0}},
                               .surface = slippery});
        test::set_motion(scene, body, {2, 0, 0}, {});
        const Corners corners(scene, body);
        World world(scene, {.method = method, .substeps = substeps, .threads = 1});
        const auto depth = [](Vec3 at) { return at.x - 0.5; };
        for (int i = 0; i < 120; ++i) {
          world.step(frame);
          ASSERT_LT(corners.deepest(world, depth), 0.01) << i;  // It comes 33 mm a step.
        }
        EXPECT_LT(corners.deepest(world, depth), 1e-3);
      }
}

enum class Floor { plane, field, box, mesh };

void add_floor(Scene& scene, Floor kind) {
  switch (kind) {
    case Floor::plane:
      scene.planes.emplace_back();
      break;
    case Floor::field:
      scene.height_fields.push_back(
          {.corner = {-4, 0, -4}, .columns = 9, .heights = std::vector<double>(81, 0)});
      break;
    case Floor::box:
      scene.boxes.push_back({.center = {0, -0.5, 0}, .half_size = {4, 0.5, 4}});
      break;
    case Floor::mesh:
      scene.meshes.push_back({.vertices = {{-9, 0, -9}, {-9, 0, 9}, {9, 0, 0}, {0, -9, 0}},
                              .triangles = {{0, 1, 2}, {1, 0, 3}, {2, 1, 3}, {0, 2, 3}},
                              .solid = true});
  }
}

/// Adds a flat tetrahedron with a sharp tip, turned about the vertical. Returns its body.
std::uint32_t add_arrow(Scene& scene, double turn) {
  const double c = std::cos(turn), s = std::sin(turn);
  Hull arrow;
  for (const Vec3 at : {Vec3{0.25, 0, 0}, {-0.1, 0, 0.1}, {-0.1, 0, -0.1}, {-0.1, 0.05, 0}})
    arrow.points.push_back({c * at.x + s * at.z, at.y, c * at.z - s * at.x});
  const Vec3 middle{-0.0125 * c, 0.0125, 0.0125 * s};
  arrow.body =
      add_body(scene, {.mass = 1, .center = middle, .inertia = {.xx = 2e-3, .yy = 3e-3, .zz = 2e-3}});
  scene.hulls.push_back(arrow);
  return arrow.body;
}

// A sharp hull slides at a wall that stands on a floor, a slop deep in that, and thus below the wall. Before,
// the wall's bottom hid the wall from it: it slid on under the wall, up to 0.3 m, and slept there.
TEST(Corners, WallsThatStandOnFloorsKeepSharpHullsOut) {
  for (const Floor floor : {Floor::plane, Floor::field, Floor::box, Floor::mesh})
    for (const Method method : {Method::automatic, Method::relax}) {
      int deep = 0;
      for (int run = 0; run < 24; ++run) {
        Scene scene;
        add_floor(scene, floor);
        scene.boxes.push_back({.center = {1.5, 0.5, 0}, .half_size = {1, 0.5, 2.5}});
        const std::uint32_t body = add_arrow(scene, 0.5 * (run % 12));
        test::set_motion(scene, body, {run < 12 ? 2.0 : 3.5, 0, 0}, {});
        const Corners corners(scene, body);
        World world(scene, {.method = method, .threads = 1});
        const auto depth = [](Vec3 at) { return at.x - 0.5; };
        double most = 0;
        for (int i = 0; i < 90; ++i) {
          world.step(frame);
          most = std::max(most, corners.deepest(world, depth));
        }
        deep += most > 0.01 ? 1 : 0;  // It comes up to 58 mm a step.
        EXPECT_LT(corners.deepest(world, depth), 1e-3) << "two slops";
      }
      EXPECT_EQ(deep, 0) << to_string(method) << " floor " << static_cast<int>(floor);
    }
}

}  // namespace
}  // namespace plumb::PLUMB_TEST_FILE
