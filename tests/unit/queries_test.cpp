// What queries find of each kind of shape and ground, where, and what filters, platforms, cuts and steps make
// of it.

#include "plumb/shapes/queries.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <string>
#include <vector>

#include "plumb/joints.hpp"
#include "queries/bare.hpp"
#include "queries/casts.hpp"
#include "queries/near_things.hpp"
#include "queries/probe.hpp"
#include "queries/query_tree.hpp"
#include "queries/solid_box.hpp"
#include "queries/things.hpp"
#include "support/bodies.hpp"
#include "support/refusals.hpp"

namespace plumb::PLUMB_TEST_FILE {
namespace {

using Kind = QueryTarget::Kind;

constexpr Vec3 along_x{1, 0, 0};
constexpr Ray look{.direction = along_x};

/// Rounding of some fifty operations on numbers of about one.
constexpr double rounding = 1e-14;

void expect_near(Vec3 is, Vec3 wanted, double tolerance, const std::string& what) {
  EXPECT_LE(norm(is - wanted), tolerance) << what << ": " << is.x << ' ' << is.y << ' ' << is.z;
}

/// The twelve triangles of a box, which face outward.
GroundMesh mesh_of_box(Vec3 center, double half) {
  GroundMesh out{.solid = true};
  for (std::uint32_t i = 0; i < 8; ++i)
    out.vertices.push_back(center + half * Vec3{i & 1 ? 1.0 : -1.0, i & 2 ? 1.0 : -1.0, i & 4 ? 1.0 : -1.0});
  out.triangles = {{0, 4, 6}, {0, 6, 2}, {1, 3, 7}, {1, 7, 5}, {0, 1, 5}, {0, 5, 4},
                   {2, 6, 7}, {2, 7, 3}, {0, 2, 3}, {0, 3, 1}, {4, 5, 7}, {4, 7, 6}};
  return out;
}

/// This is something that has its surface at x = 1 where the axis of x meets it, and its inside beyond.
struct Wall {
  const char* name;
  Scene scene;
  QueryTarget target;
  bool is_solid = true;
};

Wall wall_of(const char* name, ShapeKind list, bool is_solid = true) {
  return {name, {}, {Kind::shape, list, 0}, is_solid};
}

std::vector<Wall> walls() {
  std::vector<Wall> out;
  out.push_back(wall_of("capsule", ShapeKind::capsule));
  test::add_capsule_rod(out.back().scene, {2, -1, 0}, {2, 1, 0}, 1, 1);
  out.push_back(wall_of("ball", ShapeKind::capsule));
  test::add_ball(out.back().scene, {2, 0, 0}, 1, 1);
  out.push_back(wall_of("hull", ShapeKind::hull));
  const std::uint32_t body = test::add_fixed_body(out.back().scene);
  out.back().scene.hulls.push_back(box_on_body(body, {.center = {2, 0, 0}, .half_size = {1, 1, 1}}));
  out.push_back(wall_of("plane", ShapeKind::plane));
  out.back().scene.planes = {{.normal = {-1, 0, 0}, .offset = -1}};
  out.push_back(wall_of("box", ShapeKind::box));
  out.back().scene.boxes = {{.center = {2, 0, 0}, .half_size = {1, 1, 1}}};
  out.push_back(wall_of("ground capsule", ShapeKind::ground_capsule));
  out.back().scene.ground_capsules = {{{2, 0, -1}, {2, 0, 1}, 1}};
  out.push_back(wall_of("ground hull", ShapeKind::ground_hull));
  out.back().scene.ground_hulls = {{.points = mesh_of_box({2, 0, 0}, 0.75).vertices, .radius = 0.25}};
  out.push_back(wall_of("solid mesh", ShapeKind::mesh));
  out.back().scene.meshes = {mesh_of_box({2, 0, 0}, 1)};
  out.push_back(wall_of("sheet", ShapeKind::mesh, false));
  out.back().scene.meshes = {
      {.vertices = {{1, -2, -2}, {1, 2, -2}, {1, 2, 2}, {1, -2, 2}}, .triangles = {{0, 1, 2}, {0, 2, 3}}}};
  out.push_back({"rod", {}, {Kind::rod, ShapeKind::capsule, 0}});
  out.back().scene.particles = {{.position = {1.5, -1, 0}, .mass = 1}, {.position = {1.5, 1, 0}, .mass = 1}};
  out.back().scene.rods = {{.a = 0, .b = 1}};
  out.push_back({"particle", {}, {Kind::particle, ShapeKind::capsule, 0}});
  out.back().scene.particles = {{.position = {1.5, 0, 0}, .mass = 1}};
  return out;
}

/// Bare particles are found only where they are meant.
Queries queries_of(const Wall& wall) {
  return Queries(wall.scene, {.rod_radius = wall.target.kind == Kind::rod ? 0.5 : 0,
                              .particle_radius = wall.target.kind == Kind::particle ? 0.5 : 0});
}

TEST(Queries, RaysMeetEveryKindOfThing) {
  for (const Wall& wall : walls()) {
    const Queries queries = queries_of(wall);
    const Hit hit = queries.cast_ray(look);
    ASSERT_TRUE(hit) << wall.name;
    EXPECT_EQ(hit.target, wall.target) << wall.name;
    EXPECT_NEAR(hit.distance, 1, rounding) << wall.name;
    expect_near(hit.point, {1, 0, 0}, rounding, wall.name);
    expect_near(hit.normal, {-1, 0, 0}, rounding, wall.name);
    EXPECT_FALSE(queries.cast_ray({.direction = {-1, 0, 0}})) << wall.name;
    EXPECT_FALSE(queries.cast_ray({.direction = along_x, .length = 0.999})) << wall.name;
    EXPECT_TRUE(queries.cast_ray({.direction = {5e200, 0, 0}, .length = 1.001})) << wall.name;
  }
}

TEST(Queries, BallsTouchEveryKindOfThing) {
  for (const Wall& wall : walls()) {
    const Queries queries = queries_of(wall);
    const Hit hit = queries.cast_sphere(look, 0.25);
    ASSERT_TRUE(hit) << wall.name;
    EXPECT_EQ(hit.target, wall.target) << wall.name;
    EXPECT_NEAR(hit.distance, 0.75, rounding) << wall.name;
    expect_near(hit.point, {1, 0, 0}, rounding, wall.name);
    expect_near(hit.normal, {-1, 0, 0}, rounding, wall.name);
    EXPECT_FALSE(queries.cast_sphere({.direction = along_x, .length = 0.7}, 0.25)) << wall.name;
  }
}

// Distances of boxes are promised to 1e-8 of the sizes, which add up to 6 m at most, and normals are as good.
TEST(Queries, BoxesTouchEveryKindOfThing) {
  for (const Wall& wall : walls()) {
    const Queries queries = queries_of(wall);
    const Hit hit = queries.cast_box(look, {.half_size = {0.25, 0.5, 0.125}});
    ASSERT_TRUE(hit) << wall.name;
    EXPECT_EQ(hit.target, wall.target) << wall.name;
    EXPECT_NEAR(hit.distance, 0.75, 6e-8) << wall.name;
    EXPECT_NEAR(hit.point.x, 1, 6e-8) << wall.name;
    EXPECT_LE(std::abs(hit.point.y), 0.5 + 6e-8) << wall.name;
    expect_near(hit.normal, {-1, 0, 0}, 6e-8, wall.name);
  }
}

// A box that is turned by 45 degrees about z leads with an edge, at 0.25 · √2.
TEST(Queries, TurnedBoxesLeadWithAnEdge) {
  const double half_angle = test::degree * 22.5;
  const QueryBox box{.half_size = {0.25, 0.25, 0.25},
                     .orientation = {std::cos(half_angle), 0, 0, std::sin(half_angle)}};
  for (const Wall& wall : walls()) {
    const Queries queries = queries_of(wall);
    const Hit hit = queries.cast_box(look, box);
    EXPECT_NEAR(hit.distance, 1 - 0.25 * std::sqrt(2), 6e-8) << wall.name;
    std::vector<QueryTarget> found;
    queries.overlap_box({1 - 0.354, 0, 0}, box, found);
    EXPECT_TRUE(found.empty()) << wall.name;
    queries.overlap_box({1 - 0.353, 0, 0}, box, found);
    EXPECT_EQ(found.size(), 1u) << wall.name;
    queries.overlap_box({1 - 0.353, 0, 0}, {.half_size = {0.25, 0.25, 0.25}}, found);
    EXPECT_TRUE(found.empty()) << wall.name;
  }
}

TEST(Queries, FindWhatOverlapsAndWhatIsNearest) {
  for (const Wall& wall : walls()) {
    const Queries queries = queries_of(wall);
    std::vector<QueryTarget> found{{Kind::rod, ShapeKind::capsule, 99}};
    queries.overlap_sphere({}, 0.999, found);
    EXPECT_TRUE(found.empty()) << wall.name;
    queries.overlap_sphere({}, 1.001, found);
    EXPECT_EQ(found, std::vector{wall.target}) << wall.name;
    queries.overlap_box({}, {.half_size = {1.001, 0.1, 0.1}}, found);
    EXPECT_EQ(found, std::vector{wall.target}) << wall.name;
    queries.overlap_box({}, {.half_size = {0.999, 0.1, 0.1}}, found);
    EXPECT_TRUE(found.empty()) << wall.name;
    const Hit hit = queries.closest_point({0.5, 0, 0});
    EXPECT_EQ(hit.target, wall.target) << wall.name;
    EXPECT_NEAR(hit.distance, 0.5, rounding) << wall.name;
    expect_near(hit.point, {1, 0, 0}, rounding, wall.name);
    expect_near(hit.normal, {-1, 0, 0}, rounding, wall.name);
    EXPECT_FALSE(queries.closest_point({0.5, 0, 0}, 0.499)) << wall.name;
    EXPECT_TRUE(queries.closest_point({0.5, 0, 0}, 0.501)) << wall.name;
  }
}

TEST(Queries, WhatStartsInsideIsMetAtOnce) {
  const Vec3 inside{1.125, 0, 0};
  for (const Wall& wall : walls()) {
    const Queries queries = queries_of(wall);
    const Hit nearest = queries.closest_point(inside, 0.2);
    EXPECT_EQ(nearest.target, wall.target) << wall.name;
    EXPECT_NEAR(nearest.distance, wall.is_solid ? -0.125 : 0.125, rounding) << wall.name;
    expect_near(nearest.point, {1, 0, 0}, rounding, wall.name);
    expect_near(nearest.normal, {wall.is_solid ? -1.0 : 1.0, 0, 0}, rounding, wall.name);
    const Ray out{.origin = inside, .direction = {0, 0.6, 0.8}};
    EXPECT_EQ(bool(queries.cast_ray(out)), wall.is_solid) << wall.name;
    for (const Hit& hit : {queries.cast_sphere(out, 0.25), queries.cast_ray(out),
                           queries.cast_box(out, {.half_size = {0.25, 0.25, 0.25}})}) {
      if (!hit) continue;
      EXPECT_EQ(hit.distance, 0) << wall.name;
      EXPECT_EQ(hit.target, wall.target) << wall.name;
    }
    if (wall.is_solid) expect_near(queries.cast_ray(out).point, {1, 0, 0}, rounding, wall.name);
    std::vector<QueryTarget> found;
    queries.overlap_box({1.25, 0, 0}, {.half_size = {0.1, 0.1, 0.1}}, found);
    EXPECT_EQ(found.size(), wall.is_solid ? 1u : 0u) << wall.name;
  }
}

/// Rises by a third of a metre for each metre along x.
Scene slope() {
  Scene scene;
  HeightField field{.corner = {-3, 0, -3}, .cell_x = 3, .cell_z = 3, .columns = 3};
  for (int row = 0; row < 3; ++row)
    for (const double height : {0.0, 1.0, 2.0}) field.heights.push_back(height);
  scene.height_fields = {field};
  return scene;
}

TEST(Queries, LandscapesAreSolidBelow) {
  const Queries queries(slope());
  const Vec3 up = (1 / std::sqrt(10.0)) * Vec3{-1, 3, 0};
  const Hit hit = queries.cast_ray({.origin = {0, 5, 0.5}, .direction = {0, -2, 0}});
  EXPECT_EQ(hit.target, (QueryTarget{Kind::shape, ShapeKind::height_field, 0}));
  EXPECT_NEAR(hit.distance, 4, rounding);
  expect_near(hit.normal, up, rounding, "ray");
  EXPECT_NEAR(queries.cast_sphere({.origin = {0, 5, 0.5}, .direction = {0, -1, 0}}, 0.5).distance,
              4 - 0.5 * std::sqrt(10.0) / 3, 1e-12);
  EXPECT_EQ(queries.cast_ray({.origin = {0, 0.9, 0.5}, .direction = {0, -1, 0}}).distance, 0);
  EXPECT_EQ(queries.cast_ray({.origin = {0, -500, 0.5}, .direction = {0, 1, 0}}).distance, 0);
  EXPECT_FALSE(queries.cast_ray({.origin = {0, -1.1e6, 0.5}, .direction = {0, -1, 0}}));
  EXPECT_NEAR(queries.closest_point({0, 0, 0.5}, 0.1).distance, -3 / std::sqrt(10.0), rounding);
  // Its sides are open: what comes from there meets the landscape from below.
  const Hit below = queries.cast_ray({.origin = {5, 1, 0.5}, .direction = {-1, 0, 0}});
  EXPECT_NEAR(below.distance, 5, rounding);
  expect_near(below.normal, -1.0 * up, rounding, "from below");
  EXPECT_FALSE(queries.cast_ray({.origin = {5, -1, 0.5}, .direction = {-1, 0, 0}}));
}

TEST(Queries, WaysEndAtTheEndsOfCapsules) {
  Scene scene;
  test::add_capsule_rod(scene, {0, 0, 2}, {0, 0, 4}, 1, 0.5);
  const Queries queries(scene);
  EXPECT_NEAR(queries.cast_ray({.direction = {0, 0, 1}}).distance, 1.5, rounding);
  EXPECT_NEAR(queries.cast_ray({.origin = {0, 0, 9}, .direction = {0, 0, -1}}).distance, 4.5, rounding);
  // Off the axis, the ball at the end is met where its half chord is 0.4.
  EXPECT_NEAR(queries.cast_ray({.origin = {0.3, 0, 0}, .direction = {0, 0, 1}}).distance, 1.6, rounding);
  EXPECT_FALSE(queries.cast_ray({.origin = {0.501, 0, 0}, .direction = {0, 0, 1}}));
  EXPECT_NEAR(queries.cast_ray({.origin = {-2, 0, 1.7}, .direction = {1, 0, 0}}).distance, 1.6, rounding);
}

TEST(Queries, FiltersSayWhatIsFound) {
  Scene scene;
  test::add_ball(scene, {2, 0, 0}, 0.5, 1);
  test::add_ball(scene, {4, 0, 0}, 0.5, 1);
  scene.capsules[0].filter = {.category = 2, .group = -7};
  scene.capsules[1].filter.mask = 4;
  scene.planes = {{.normal = {-1, 0, 0}, .offset = -6, .filter = {.category = 8}}};
  scene.particles.push_back({.position = {8, -1, 0}, .mass = 1});
  scene.particles.push_back({.position = {8, 1, 0}, .mass = 1});
  scene.rods = {{.a = 2, .b = 3}};
  const Queries queries(scene, {.rod_radius = 0.5});
  const auto found = [&](const QueryFilter& filter) { return queries.cast_ray(look, filter).distance; };
  EXPECT_EQ(found({}), 1.5);
  EXPECT_EQ(found({.filter = {.mask = ~2u}}), 6);  // the second wants category 4
  EXPECT_EQ(found({.filter = {.category = 4, .mask = ~2u}}), 3.5);
  EXPECT_EQ(found({.filter = {.group = -7}}), 6);
  EXPECT_EQ(found({.shapes = false}), 6);
  EXPECT_EQ(found({.shapes = false, .ground = false}), 7.5);
  EXPECT_EQ(found({.filter = {.mask = ~1u}, .shapes = false, .ground = false}), INFINITY);
  EXPECT_EQ(found({.shapes = false, .ground = false, .bare = false}), INFINITY);
  std::vector<QueryTarget> list;
  queries.overlap_sphere({2, 0, 0}, 4.5, list);
  EXPECT_EQ(list.size(), 2u);
  queries.overlap_sphere({2, 0, 0}, 4.5, list, {.shapes = false});
  EXPECT_EQ(list, (std::vector<QueryTarget>{{Kind::shape, ShapeKind::plane, 0}}));
  EXPECT_EQ(queries.closest_point({4, 0, 0}, 9, {.filter = {.category = 4}}).target.number, 1u);
  EXPECT_EQ(queries.closest_point({4, 0, 0}, 9, {.filter = {.category = 2}}).distance, 1.5);
}

// Rods under capsules and those of bodies are shown already.
TEST(Queries, OnlyBareRodsAndParticlesCount) {
  Scene scene;
  test::add_capsule_rod(scene, {1, -1, 0}, {1, 1, 0}, 1, 0.01);
  const std::uint32_t body = test::add_fixed_body(scene);
  scene.particles.push_back({.position = {5, 0, 0}, .mass = 1});
  scene.particles.push_back({.position = {6, 0, 0}, .mass = 1});
  scene.rods.push_back({.a = scene.bodies[body].particles[0], .b = 6});
  scene.rods.push_back({.a = 6, .b = 7});
  std::vector<QueryTarget> list;
  Queries(scene, {.rod_radius = 0.1}).overlap_sphere({}, 100, list, {.shapes = false});
  const auto last = static_cast<std::uint32_t>(scene.rods.size() - 1);
  EXPECT_EQ(list, (std::vector<QueryTarget>{{Kind::rod, {}, last - 1}, {Kind::rod, {}, last}}));
  Queries(scene, {.particle_radius = 0.1}).overlap_sphere({}, 100, list, {.shapes = false});
  EXPECT_EQ(list, (std::vector<QueryTarget>{{Kind::particle, {}, 6}, {Kind::particle, {}, 7}}));
  Queries(scene).overlap_sphere({}, 100, list, {.shapes = false});
  EXPECT_TRUE(list.empty());
}

TEST(Queries, OfEqualDistancesTheFirstCounts) {
  Scene scene;
  for (int i = 0; i < 40; ++i) test::add_ball(scene, {2, 0, 0}, 0.5, 1);
  scene.boxes = {{.center = {2.5, 0, 0}, .half_size = {1, 1, 1}}};
  scene.planes = {{.normal = {-1, 0, 0}, .offset = -1.5}};
  const Queries queries(scene);
  EXPECT_EQ(queries.cast_ray(look).target, (QueryTarget{Kind::shape, ShapeKind::capsule, 0}));
  EXPECT_EQ(queries.cast_ray(look, {.shapes = false}).target,
            (QueryTarget{Kind::shape, ShapeKind::plane, 0}));
  EXPECT_EQ(queries.closest_point({}).target.number, 0u);
}

TEST(Queries, FollowSteps) {
  Scene scene;
  test::add_ball(scene, {0, 10, 0}, 0.5, 1);
  const std::uint32_t body = add_body(scene, solid_sphere(1, 0.5));
  scene.hulls = {box_on_body(body, {.half_size = {1, 1, 1}})};
  test::set_motion(scene, body, {3, 0, 0}, {});
  World world(scene, test::body_settings());
  Queries queries(scene);
  for (int i = 0; i < 30; ++i) world.step(test::frame);
  const Ray down{.origin = {0, 20, 0}, .direction = {0, -1, 0}};
  EXPECT_EQ(queries.cast_ray(down).distance, 9.5);
  queries.update(world);
  EXPECT_NEAR(queries.cast_ray(down).distance, 20 - world.position(0).y - 0.5, rounding);
  const Pose pose = world.pose(body);
  const Hit hit = queries.cast_ray({.origin = {pose.position.x + 0.3, -50, 0}, .direction = {0, 1, 0}});
  EXPECT_EQ(hit.target, (QueryTarget{Kind::shape, ShapeKind::hull, 0}));
  EXPECT_NEAR(hit.point.y, pose.position.y - 1, 1e-12);
}

TEST(Queries, GroundIsWhereItsPlatformIs) {
  Scene scene;
  scene.platforms = {{}, {}};
  scene.boxes = {{.center = {2, 0, 0}, .half_size = {0.5, 0.5, 0.5}, .motion = {.platform = 0}}};
  scene.planes = {{.normal = {-1, 0, 0}, .offset = -5, .motion = {.platform = 1}}};
  test::add_ball(scene, {0, 50, 0}, 0.1, 1);
  World world(scene, test::body_settings());
  Queries queries(scene);
  EXPECT_EQ(queries.cast_ray(look).distance, 1.5);
  world.move_platform(0, {.position = {0, 3, 0}});
  world.move_platform(1, {.position = {2, 0, 0}});
  world.step(test::frame);
  queries.update(world);
  EXPECT_NEAR(queries.cast_ray(look).distance, 7, rounding);
  EXPECT_NEAR(queries.cast_ray({.origin = {0, 3, 0}, .direction = along_x}).distance, 1.5, rounding);
  // By a quarter of a turn about y, which takes x to -z.
  const double half = std::sqrt(0.5);
  world.move_platform(0, {.position = {}, .orientation = {half, 0, half, 0}});
  world.move_platform(1, {});
  world.step(test::frame);
  queries.update(world);
  EXPECT_NEAR(queries.cast_ray({.direction = {0, 0, -1}}).distance, 1.5, 1e-12);
  EXPECT_EQ(queries.cast_ray(look).distance, 5);
}

/// Makes three rods along y at x = 2 m, the lowest end of them fixed.
Scene line_of_rods() {
  Scene scene;
  scene.gravity = {};
  for (std::uint32_t i = 0; i < 4; ++i) {
    scene.particles.push_back({.position = {2, 1.0 * i, 0}, .mass = 1, .fixed = i == 0});
    if (i > 0) scene.rods.push_back({.a = i - 1, .b = i});
  }
  return scene;
}

TEST(Queries, BrokenRodsAreGone) {
  const Scene scene = line_of_rods();
  World world(scene);
  Queries queries(scene, {.rod_radius = 0.1});
  const Ray middle{.origin = {0, 1.5, 0}, .direction = along_x};
  EXPECT_EQ(queries.cast_ray(middle).target, (QueryTarget{Kind::rod, {}, 1}));
  std::vector<std::byte> saved(world.snapshot_size());
  world.save(saved);
  world.cut(1);
  world.step(test::frame);
  queries.update(world);
  EXPECT_FALSE(queries.cast_ray(middle));
  EXPECT_TRUE(queries.cast_ray({.origin = {0, 2.5, 0}, .direction = along_x}));
  world.restore(saved);
  queries.update(world);
  EXPECT_TRUE(queries.cast_ray(middle));
}

TEST(Queries, CapsulesEndWithTheirRods) {
  for (const Method method : {Method::direct, Method::relax}) {
    Scene scene = line_of_rods();
    for (const Rod& rod : scene.rods)
      scene.capsules.push_back({.a = point_at(rod.a), .b = point_at(rod.b), .radius = 0.1});
    Settings settings;
    settings.method = method;
    World world(scene, settings);
    Queries queries(scene);
    const Ray middle{.origin = {0, 1.5, 0}, .direction = along_x},
        last{.origin = {0, 2.5, 0}, .direction = along_x};
    const ShapeId cut{ShapeKind::capsule, 1}, whole{ShapeKind::capsule, 2};
    EXPECT_EQ(queries.cast_ray(middle).target, (QueryTarget{Kind::shape, ShapeKind::capsule, 1}));
    std::vector<std::byte> saved(world.snapshot_size());
    world.save(saved);
    world.cut(1);
    world.step(test::frame);
    queries.update(world);
    EXPECT_FALSE(world.has_shape(cut));
    EXPECT_TRUE(world.has_shape(whole));
    EXPECT_FALSE(queries.cast_ray(middle));
    EXPECT_EQ(queries.cast_ray(last).target, (QueryTarget{Kind::shape, ShapeKind::capsule, 2}));
    world.restore(saved);
    queries.update(world);
    EXPECT_TRUE(world.has_shape(cut));
    EXPECT_TRUE(queries.cast_ray(middle));
    EXPECT_THROW(world.has_shape({ShapeKind::capsule, 3}), InputError);
    EXPECT_THROW(world.has_shape({ShapeKind::plane, 0}), InputError);
    world.remove(1);
    EXPECT_FALSE(world.has_shape(whole));
  }
}

// Numbers of what was removed go to what is added. Of what is there a ray finds the first, whichever came
// when.
TEST(Queries, FindWhatWasAddedAndNotWhatWasRemoved) {
  Scene scene;
  scene.gravity = {};
  for (std::uint32_t i = 0; i < 4; ++i) {
    scene.particles.push_back({.position = {2, 1.0 * i, 0}, .mass = 1, .fixed = i % 2 == 0});
    if (i % 2 == 1) scene.rods.push_back({.a = i - 1, .b = i});
  }
  World world(scene);
  Queries queries(scene, {.rod_radius = 0.1, .particle_radius = 0.2});
  const Ray low{.origin = {0, 0.5, 0}, .direction = along_x},
      high{.origin = {0, 2.5, 0}, .direction = along_x};
  const Ray end{.origin = {0, 1, 0}, .direction = along_x},
      origin{.origin = {-2, 0, 0}, .direction = along_x};
  EXPECT_EQ(queries.cast_ray(low).target, (QueryTarget{Kind::rod, {}, 0}));
  EXPECT_EQ(queries.cast_ray(end).target, (QueryTarget{Kind::particle, {}, 1}));
  world.remove(1);
  queries.update(world);
  for (const Ray& ray : {low, end, origin}) EXPECT_FALSE(queries.cast_ray(ray));
  EXPECT_EQ(queries.cast_ray(high).target, (QueryTarget{Kind::rod, {}, 1}));
  Scene added;
  for (std::uint32_t i = 0; i < 5; ++i) {
    added.particles.push_back({.position = {2, 0.25 * i, 0}, .mass = 1, .fixed = i == 0});
    if (i > 0) added.rods.push_back({.a = i - 1, .b = i});
  }
  world.add(added);
  EXPECT_FALSE(queries.cast_ray(low)) << "not before update()";
  queries.update(world);
  EXPECT_EQ(world.rod_count(), 6u);
  // Of the two particles that ended, one number is free alone, so that the five new ones have those behind.
  EXPECT_EQ(queries.cast_ray(low).target, (QueryTarget{Kind::particle, {}, 6}));
  EXPECT_EQ(queries.cast_ray(end).target, (QueryTarget{Kind::particle, {}, 8}));
  EXPECT_EQ(queries.cast_ray(high).target, (QueryTarget{Kind::rod, {}, 1}));
  // Without particles the rods between them are found, until one is cut.
  Queries rods(scene, {.rod_radius = 0.1});
  const Ray last{.origin = {0, 0.875, 0}, .direction = along_x};
  rods.update(world);
  EXPECT_EQ(rods.cast_ray(last).target, (QueryTarget{Kind::rod, {}, 5}));
  std::vector<std::byte> saved(world.snapshot_size());
  world.save(saved);
  world.cut(5);
  world.step(1e-6);
  rods.update(world);
  EXPECT_FALSE(rods.cast_ray(last));
  world.restore(saved);
  rods.update(world);
  EXPECT_TRUE(rods.cast_ray(last));
}

TEST(Queries, FindWhatIsJoined) {
  Scene scene;
  scene.gravity = {};
  scene.particles = {{.position = {2, -1, 0}, .mass = 1}, {.position = {2, 1, 0}, .mass = 1}};
  World world(scene);
  Queries queries(scene, {.rod_radius = 0.1});
  EXPECT_FALSE(queries.cast_ray(look));
  world.join({.a = 0, .b = 1});
  queries.update(world);
  EXPECT_FALSE(queries.cast_ray({.origin = {0, -1, 0}, .direction = along_x})) << "it waits for a step";
  world.step(1e-3);
  queries.update(world);
  const Hit hit = queries.cast_ray(look);
  EXPECT_EQ(hit.target, (QueryTarget{Kind::rod, {}, 0}));
  EXPECT_NEAR(hit.distance, 1.9, rounding);
}

// Islands that lost their places are not found, and the others are.
TEST(Things, WhatHasNoFinitePlaceIsGone) {
  using Form = detail::Thing::Form;
  Scene scene;
  test::add_ball(scene, {2, 0, 0}, 0.5, 1);
  test::add_ball(scene, {4, 0, 0}, 0.5, 1);
  const std::uint32_t body = add_body(scene, solid_sphere(1, 0.5));
  scene.hulls = {box_on_body(body, {.half_size = {1, 1, 1}})};
  detail::Things things(scene, {});
  std::vector<Vec3> positions;
  for (const Particle& particle : scene.particles) positions.push_back(particle.position);
  const std::vector<std::uint8_t> broken(scene.rods.size()), ended(scene.capsules.size()),
      replaced(scene.particles.size());
  const auto forms = [&] {
    things.update({positions, replaced, broken, ended, {}, {}});
    return std::vector{things.list()[0].form, things.list()[1].form, things.list()[2].form};
  };
  EXPECT_EQ(forms(), (std::vector{Form::capsule, Form::capsule, Form::solid}));
  std::vector<Vec3> good = positions;
  positions[0].y = std::numeric_limits<double>::quiet_NaN();
  positions[2].z = INFINITY;
  EXPECT_EQ(forms(), (std::vector{Form::gone, Form::capsule, Form::gone}));
  EXPECT_TRUE(things.bounds()[0].is_empty());
  positions = good;
  EXPECT_EQ(forms(), (std::vector{Form::capsule, Form::capsule, Form::solid}));
}

TEST(Queries, RaysInBulkAreThoseAlone) {
  const std::vector<Wall> all = walls();
  const Queries queries = queries_of(all[0]);
  std::vector<Ray> rays{look, {.direction = {-1, 0, 0}}, {.origin = {0, 1, 0}, .direction = {2, 0, 0}}};
  std::vector<Hit> hits(3);
  queries.cast_rays(rays, hits);
  for (std::size_t i = 0; i < 3; ++i) {
    const Hit alone = queries.cast_ray(rays[i]);
    EXPECT_EQ(hits[i].target, alone.target);
    EXPECT_EQ(hits[i].distance, alone.distance);
    EXPECT_EQ(hits[i].point, alone.point);
  }
  rays[2].length = -1;
  hits[0].distance = 77;
  EXPECT_EQ(test::refusal([&] { queries.cast_rays(rays, hits); }),
            "ray 2: length must not be negative, got -1 m");
  EXPECT_EQ(hits[0].distance, 77);
  EXPECT_EQ(test::refusal([&] { queries.cast_rays(rays, std::span(hits).first(2)); }),
            "hits of 3 rays cannot be written into 2 elements");
}

TEST(Queries, RefuseWhatMakesNoSense) {
  const double nan = std::numeric_limits<double>::quiet_NaN();
  const Queries queries = queries_of(walls()[0]);
  const auto ray = [&](const Ray& of) { return test::refusal([&] { queries.cast_ray(of); }); };
  EXPECT_EQ(ray({.origin = {nan, 0, 0}, .direction = along_x}), "ray: origin is not finite");
  EXPECT_EQ(ray({.direction = {INFINITY, 0, 0}}), "ray: direction is not finite");
  EXPECT_EQ(ray({}), "ray: direction must not be zero");
  EXPECT_NE(ray({.direction = along_x, .length = nan}), "");
  EXPECT_NE(test::refusal([&] { queries.cast_sphere(look, -1); }), "");
  EXPECT_NE(test::refusal([&] { queries.cast_sphere(look, INFINITY); }), "");
  for (const QueryBox& box : {QueryBox{.half_size = {1, -1, 1}}, QueryBox{.half_size = {1, nan, 1}},
                              QueryBox{.half_size = {1, 1, 1}, .orientation = {1, 0.1, 0, 0}}}) {
    std::vector<QueryTarget> found(3);
    EXPECT_NE(test::refusal([&] { queries.cast_box(look, box); }), "");
    EXPECT_NE(test::refusal([&] { queries.overlap_box({}, box, found); }), "");
    EXPECT_NE(test::refusal([&] { queries.overlap_sphere({0, nan, 0}, 1, found); }), "");
    EXPECT_EQ(found.size(), 3u);
  }
  EXPECT_NE(test::refusal([&] { queries.closest_point({0, 0, nan}); }), "");
  EXPECT_NE(test::refusal([&] { queries.closest_point({}, -1); }), "");
  EXPECT_NE(test::refusal([&] { queries.closest_point({}, nan); }), "");
  Scene scene = walls()[0].scene;
  EXPECT_EQ(test::refusal([&] { Queries(scene, {.rod_radius = -1}); }),
            "rod_radius must be finite and not negative, got -1 m");
  EXPECT_NE(test::refusal([&] { Queries(scene, {.particle_radius = nan}); }), "");
  scene.capsules[0].radius = -1;
  EXPECT_NE(test::refusal([&] { Queries{scene}; }), "");
}

TEST(Queries, RefuseWorldsOfOtherScenes) {
  Scene scene = walls()[0].scene;
  Queries queries(scene);
  Scene fewer;
  fewer.particles.push_back({.mass = 1});
  EXPECT_EQ(test::refusal([&] { queries.update(World(fewer)); }),
            "the world has 1 particles, and the scene of these queries has 2");
  EXPECT_TRUE(queries.cast_ray(look));
}

TEST(Queries, NothingIsFoundWhereNothingIs) {
  Scene scene;
  scene.particles = {{.mass = 1}};
  const Queries queries(scene);
  EXPECT_FALSE(queries.cast_ray(look));
  EXPECT_FALSE(queries.closest_point({}));
}

}  // namespace
}  // namespace plumb::PLUMB_TEST_FILE
