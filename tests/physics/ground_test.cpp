// Things land on every kind of ground, rest there and sleep; and floors of triangles are planes to what
// slides.

#include "plumb/shapes/ground.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <string>

#include "contact/shapes/meshes/triangle.hpp"
#include "plumb/shapes/surface.hpp"
#include "support/bodies.hpp"
#include "support/meshes.hpp"

namespace plumb::PLUMB_TEST_FILE {
namespace {

using test::frame;

/// Ground about the origin whose top is at heights from -0.3 to 0.3 m, and how far (m) places are above it.
struct Ground {
  const char* name;
  Scene scene;
  std::function<double(Vec3)> distance;
};

/// Below a surface a way up crosses it an odd number of times.
double distance_from(const test::Mesh& mesh, Vec3 p) {
  double least = INFINITY;
  bool is_below = false;
  for (const auto& [a, b, c] : mesh.triangles) {
    const detail::Triangle triangle{mesh.vertices[a], mesh.vertices[b], mesh.vertices[c]};
    least = std::min(least, norm(p - detail::nearest_on(triangle, p).at));
    is_below ^= detail::crosses(triangle, p, p + Vec3{0.123, 10, 0.0456});
  }
  return is_below ? -least : least;
}

std::vector<Ground> all_grounds() {
  std::vector<Ground> out;
  test::Random random(81);
  const Surface surface{.friction = 0.6};
  const auto flat = [](Vec3 p) { return p.y; };

  Ground plane{"plane", {}, flat};
  plane.scene.planes.push_back({.surface = surface});
  out.push_back(plane);
  Ground box{"box", {}, flat};
  box.scene.boxes.push_back({.center = {0, -1, 0}, .half_size = {2, 1, 2}, .surface = surface});
  out.push_back(box);
  Ground hull{"hull", {}, flat};
  hull.scene.ground_hulls.push_back({.surface = surface});
  for (const double x : {-2.0, 2.0})
    for (const double z : {-2.0, 2.0}) {
      hull.scene.ground_hulls[0].points.push_back({x, 0, z});
      hull.scene.ground_hulls[0].points.push_back({1.5 * x, -1, 1.5 * z});
    }
  out.push_back(hull);

  Ground spheres{"spheres", {}, {}}, capsules{"capsules", {}, {}};
  for (int i = -8; i <= 8; ++i) {
    capsules.scene.ground_capsules.push_back({{-3, 0, 0.25 * i}, {3, 0, 0.25 * i}, 0.2, surface});
    for (int k = -8; k <= 8; ++k)
      spheres.scene.ground_capsules.push_back(
          {{0.25 * k, 0, 0.25 * i}, {0.25 * k, 0, 0.25 * i}, 0.2, surface});
  }
  for (Ground* each : {&spheres, &capsules}) {
    each->distance = [list = each->scene.ground_capsules](Vec3 p) {
      double least = INFINITY;
      for (const GroundCapsule& c : list)
        least = std::min(least, norm(p - Vec3{std::clamp(p.x, c.a.x, c.b.x), 0, c.a.z}) - c.radius);
      return least;
    };
    out.push_back(*each);
  }

  Ground sheet{"sheet", {}, flat}, solid{"solid", {}, {}}, field{"height field", {}, {}};
  const test::Mesh tiles = test::shuffled_floor(40, 0.1, random);
  sheet.scene.meshes.push_back({tiles.vertices, tiles.triangles, false, surface});
  out.push_back(sheet);

  test::Mesh step = test::l_shape();
  for (Vec3& v : step.vertices) v = Vec3{2 * v.x - 2, 0.2 * v.y - 0.2, 4 * v.z - 2};
  solid.scene.meshes.push_back({step.vertices, step.triangles, true, surface});
  solid.distance = [step](Vec3 p) { return distance_from(step, p); };
  out.push_back(solid);

  const test::Mesh hills = test::landscape(
      24, 0.2, [](double x, double z) { return 0.08 * std::sin(3 * x) * std::cos(2 * z) + 0.02 * x * x; });
  HeightField& heights = field.scene.height_fields.emplace_back();
  heights = {.corner = {-2.4, 0, -2.4}, .cell_x = 0.2, .cell_z = 0.2, .columns = 25, .surface = surface};
  for (const Vec3 v : hills.vertices) heights.heights.push_back(v.y);
  field.distance = [hills](Vec3 p) { return distance_from(hills, p); };
  out.push_back(field);
  return out;
}

/// Contact is solved, or relaxed in either precision.
struct Way {
  const char* name;
  Settings settings;
};
std::vector<Way> all_ways(std::uint32_t substeps, bool sleep = false) {
  Settings relaxed{.method = Method::relax, .substeps = 2 * substeps, .sleep = sleep, .threads = 1};
  relaxed.stop.sweeps = 20;
  Settings single = relaxed;
  single.precision = Precision::single;
  return {{"solved", test::body_settings(substeps, sleep)}, {"relaxed", relaxed}, {"relaxed, float", single}};
}

Vec3 place(const World& world, const Point& point) {
  Vec3 sum{};
  for (std::size_t k = 0; k < 4; ++k)
    if (point.weights[k] != 0) sum += point.weights[k] * world.position(point.particles[k]);
  return sum;
}

/// The deepest of a scene's capsules, by samples along them, m.
double depth(const Ground& ground, const Scene& scene, const World& world) {
  double deepest = -INFINITY;
  for (const Capsule& capsule : scene.capsules)
    for (int i = 0; i <= 8; ++i) {
      const Vec3 a = place(world, capsule.a), b = place(world, capsule.b);
      deepest = std::max(deepest, capsule.radius - ground.distance(a + (i / 8.0) * (b - a)));
    }
  return deepest;
}

/// The deepest of a scene's hulls, by samples of their edges, m.
double hull_depth(const Ground& ground, const Scene& scene, const World& world) {
  double deepest = -INFINITY;
  for (const Hull& hull : scene.hulls) {
    std::vector<Vec3> corners;
    for (const Vec3 point : hull.points)
      corners.push_back(place(world, point_on_body(scene, hull.body, point)));
    for (const Vec3 a : corners)
      for (const Vec3 b : corners)
        for (int i = 0; i <= 4; ++i)
          deepest = std::max(deepest, hull.radius - ground.distance(a + (i / 4.0) * (b - a)));
  }
  return deepest;
}

/// Lets what was added to a ground's scene fall, for `seconds`, in `substeps` a frame. Nothing is ever deeper
/// than a millimetre, and all sleeps in the end. A millimetre is twice ContactSettings::slop, which is left
/// of any overlap: as much again is for links and corners that touch elsewhere at a substep's end than at its
/// start. What lies keeps within the margin of 2 mm, and samples may miss by 1 mm where it does.
void expect_rest(const Ground& ground, const Scene& scene, double seconds, std::uint32_t substeps = 8) {
  for (const Way& way : all_ways(substeps, true)) {
    SCOPED_TRACE(std::string(ground.name) + ", " + way.name);
    World world(scene, way.settings);
    double deepest = -INFINITY;
    std::uint64_t awake = 1;
    while (world.time() < seconds && awake > 0) {
      const StepReport report = world.step(frame);
      ASSERT_EQ(report.unsolved, 0u) << world.time();
      deepest = std::max({deepest, depth(ground, scene, world), hull_depth(ground, scene, world)});
      awake = report.awake_islands;
    }
    EXPECT_EQ(awake, 0u);
    EXPECT_LT(deepest, 1e-3);
    EXPECT_GT(std::max(depth(ground, scene, world), hull_depth(ground, scene, world)), -3e-3)
        << "it lies on the ground";
  }
}

TEST(Ground, BallsRest) {
  for (const Ground& ground : all_grounds()) {
    Scene scene = ground.scene;
    scene.particles.push_back({.position = {0.13, 0.8, 0.21}, .mass = 1});
    scene.capsules.push_back({point_at(0), point_at(0), 0.1, {.friction = 0.6}});
    scene.drag = 0.5;  // balls roll
    expect_rest(ground, scene, 30);
  }
}

TEST(Ground, RopesRest) {
  for (const Ground& ground : all_grounds()) {
    Scene scene = ground.scene;
    const int links = 20;
    scene.drag = 0.5;  // what hangs over a step swings
    for (int i = 0; i <= links; ++i)
      scene.particles.push_back({.position = {0.05 * i - 0.5, 0.6 + 0.01 * i, 0.03 * i - 0.3}, .mass = 0.05});
    for (std::uint32_t i = 0; i < links; ++i) {
      scene.rods.push_back({.a = i, .b = i + 1});
      scene.capsules.push_back({point_at(i), point_at(i + 1), 0.015, {.friction = 0.6}});
    }
    // Links that swing over an edge touch it elsewhere at the end of a substep than at its start. So depth
    // falls with the substep: 1.05, 0.50 and 0.16 mm at 8, 16 and 32 substeps.
    expect_rest(ground, scene, 20, 12);
  }
}

/// Adds a box of half sizes `half` as a body, its shape turned about z.
std::uint32_t add_box(Scene& scene, Vec3 center, Vec3 half, Surface surface, double turn = 0) {
  MassProperties box = solid_box(2, 2.0 * half);
  box.center = center;
  const std::uint32_t body = add_body(scene, box);
  scene.hulls.push_back(box_on_body(body, {.center = center,
                                           .half_size = half,
                                           .orientation = {std::cos(turn / 2), 0, 0, std::sin(turn / 2)},
                                           .surface = surface}));
  return body;
}

TEST(Ground, BoxesRest) {
  for (const Ground& ground : all_grounds()) {
    Scene scene = ground.scene;
    add_box(scene, {-0.4, 0.6, 0.1}, {0.15, 0.1, 0.2}, {.friction = 0.6}, 0.3);
    expect_rest(ground, scene, 20);
  }
}

/// What slides: a ball, a rope and a box, fast enough to cross many triangles.
Scene sliders(const Scene& ground) {
  Scene scene = ground;
  const Surface surface{.friction = 0.3};
  const Vec3 velocity{2, 0, 0.3};
  scene.particles.push_back({.position = {-1.4, 0.1, 0.9}, .velocity = velocity, .mass = 1});
  scene.capsules.push_back({point_at(0), point_at(0), 0.1, surface});
  for (std::uint32_t i = 0; i <= 10; ++i)
    scene.particles.push_back(
        {.position = {-1.4 + 0.02 * i, 0.02, -0.9 + 0.06 * i}, .velocity = velocity, .mass = 0.05});
  for (std::uint32_t i = 1; i <= 10; ++i) {
    scene.rods.push_back({.a = i, .b = i + 1});
    scene.capsules.push_back({point_at(i), point_at(i + 1), 0.02, surface});
  }
  add_box(scene, {-1.2, 0.1, 0.3}, {0.15, 0.1, 0.2}, surface);
  for (const std::uint32_t particle : scene.bodies[0].particles)
    scene.particles[particle].velocity = velocity;
  return scene;
}

/// Level floors of many pieces, whose tops are at height 0.
std::vector<Ground> floors(const Surface& surface) {
  test::Random random(82);
  const auto flat = [](Vec3 p) { return p.y; };
  Ground tiles{"triangles", {}, flat}, field{"height field", {}, flat}, boxes{"boxes", {}, flat},
      hulls{"hulls", {}, flat};
  const test::Mesh floor = test::shuffled_floor(60, 0.07, random);
  tiles.scene.meshes.push_back({floor.vertices, floor.triangles, false, surface});
  field.scene.height_fields.push_back({.corner = {-2.1, 0, -2.1},
                                       .cell_x = 0.06,
                                       .cell_z = 0.07,
                                       .columns = 71,
                                       .heights = std::vector<double>(71 * 61),
                                       .surface = surface});
  for (int i = -6; i <= 6; ++i)
    for (int k = -6; k <= 6; ++k) {
      const Box box{.center = {0.3 * i + 0.05 * (k % 3), -0.2, 0.3 * k},
                    .half_size = {0.15, 0.2, 0.15},
                    .surface = surface};
      boxes.scene.boxes.push_back(box);
      hulls.scene.ground_hulls.push_back({.points = box_on_body(0, box).points, .surface = surface});
    }
  return {tiles, field, boxes, hulls};
}

// A floor of many pieces is a plane to what slides and brakes there. Paths differ by what is left of solving:
// 1e-5 m is ContactSettings::tolerance, by which a substep may miss a gap. On solids ropes touch seams twice,
// and friction is shared otherwise; 1e-3 m, of ways of up to a metre, is a bound on what was measured there.
TEST(Ground, FloorsOfManyPiecesArePlanes) {
  const Surface surface{.friction = 0.3};
  Scene plane;
  plane.planes.push_back({.surface = surface});
  for (const Ground& floor : floors(surface))
    for (const Way& way : all_ways(4)) {
      SCOPED_TRACE(std::string(floor.name) + ", " + way.name);
      World reference(sliders(plane), way.settings), world(sliders(floor.scene), way.settings);
      double off = 0;
      for (int i = 0; i < 60; ++i) {
        for (World* const each : {&reference, &world}) ASSERT_EQ(each->step(frame).unsolved, 0u);
        for (std::uint32_t k = 0; k < reference.particle_count(); ++k)
          off = std::max(off, norm(world.position(k) - reference.position(k)));
      }
      EXPECT_LT(off, floor.scene.meshes.size() + floor.scene.height_fields.size() > 0 ? 1e-5 : 1e-3);
      EXPECT_GT(reference.position(0).x, -0.75) << "it slid over many pieces";
    }
}

// What slides without friction loses and gains nothing at edges between pieces. In a substep sweeps leave
// sweep_tolerance g h/2 = 8e-5 m/s.
TEST(Ground, FloorsOfManyPiecesTakeNoEnergy) {
  for (const Ground& floor : floors({.friction = 0}))
    for (const Way& way : all_ways(4)) {
      SCOPED_TRACE(std::string(floor.name) + ", " + way.name);
      World world(sliders(floor.scene), way.settings);
      double off = 0;
      for (int i = 0; i < 80; ++i) {
        ASSERT_EQ(world.step(frame).unsolved, 0u);
        for (std::uint32_t k = 0; k < world.particle_count(); ++k)
          off = std::max(off, norm(world.velocity(k) - Vec3{2, 0, 0.3}));
      }
      EXPECT_LT(off, 2e-4);
      EXPECT_GT(world.position(0).x, 1.2);
    }
}

// The forces on a box that lies on ground are its weight. In a substep sweeps may leave 4e-3 of what gravity
// does (sweep_tolerance), with either sign; the mean over a second may be off by half of that.
TEST(Ground, PushesWithTheWeight) {
  for (const Ground& ground : all_grounds()) {
    SCOPED_TRACE(ground.name);
    Scene scene = ground.scene;
    add_box(scene, {-0.9, 0.6, 0.1}, {0.3, 0.1, 0.3}, {.friction = 0.8});
    Settings settings = test::body_settings(4);
    settings.tensions = true;
    World world(scene, settings);
    Vec3 sum{};
    for (int i = 0; i < 360; ++i) {
      world.step(frame);
      if (i >= 300) sum += (1.0 / 60) * world.contact_force(0);
    }
    EXPECT_NEAR(sum.y, 2 * test::earth, 2e-3 * 2 * test::earth);
  }
}

// A tower of boxes stands and sleeps, one above the other; a ball and a rod lie on the topmost. Each of the
// six contacts below them may keep an overlap of the slop, 0.5 mm: 3 mm together. One more is for what boxes
// slide aside while they settle.
TEST(Hulls, StandOnEachOther) {
  Scene scene;
  const Surface surface{.friction = 0.6};
  scene.planes.push_back({.surface = surface});
  for (int i = 0; i < 5; ++i) add_box(scene, {0.01 * i, 0.1 + 0.2 * i, 0}, {0.2, 0.1, 0.2}, surface);
  const std::uint32_t ball = test::add_ball(scene, {0.05, 1.05, 0.1}, 0.05, 0.1, {}, surface);
  const std::uint32_t rod =
      test::add_capsule_rod(scene, {-0.1, 1.03, 0}, {0.1, 1.03, -0.1}, 0.2, 0.03, surface);
  World world(scene, test::body_settings(4, true));
  std::uint64_t awake = 1;
  for (int i = 0; i < 600 && awake > 0; ++i) {
    const StepReport report = world.step(frame);
    ASSERT_EQ(report.unsolved, 0u);
    awake = report.awake_islands;
  }
  EXPECT_EQ(awake, 0u);
  EXPECT_NEAR(world.position(ball).y, 1.05, 4e-3);
  EXPECT_NEAR(world.position(scene.rods[rod].a).y, 1.03, 4e-3);
  for (std::uint32_t i = 0; i < 5; ++i) {
    const Vec3 middle = place(world, point_on_body(scene, i, scene.bodies[i].center));
    EXPECT_LT(norm(middle - scene.bodies[i].center), 4e-3);
  }
}

}  // namespace
}  // namespace plumb::PLUMB_TEST_FILE
