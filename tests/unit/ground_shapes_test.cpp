// Ground as contact sees it: what is refused, floors of many solids, corners of walls, and hulls that move.

#include <gtest/gtest.h>

#include <cmath>

#include "contact/ground/ground_search.hpp"
#include "contact/ground/ground_shape.hpp"
#include "contact/ground/placed_hulls.hpp"
#include "plumb/joints.hpp"
#include "plumb/shapes/ground.hpp"
#include "scene/ground/validate_ground.hpp"
#include "support/meshes.hpp"
#include "support/refusals.hpp"

namespace plumb::detail::PLUMB_TEST_FILE {
namespace {

constexpr double close = 1e-5;
constexpr GroundSearch search{2e-3, close};

Box box_at(Vec3 center, Vec3 half) {
  return {.center = center, .half_size = half};
}

TEST(GroundChecks, NameWhatIsWrong) {
  Scene sound;
  const test::Mesh solid = test::l_shape();
  sound.ground_capsules = {{{0, 0, 0}, {1, 0, 0}, 0.1, {}}};
  sound.ground_hulls = {{.points = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}}}};
  sound.meshes = {{solid.vertices, solid.triangles, true, {}}};
  sound.height_fields = {{.columns = 2, .heights = {0, 0, 0, 0}}};
  const auto refusal_after = [&](auto&& change) {
    Scene scene = sound;
    change(scene);
    return test::refusal([&] { validate_ground(scene); });
  };
  EXPECT_EQ(refusal_after([](Scene&) {}), "");
  EXPECT_EQ(refusal_after([](Scene& s) { s.ground_capsules[0].radius = -1; }),
            "ground capsule 0: radius must be finite and not negative, got -1 m");
  EXPECT_EQ(refusal_after([](Scene& s) {
              s.ground_hulls[0].points[3] = {1, 1, 0};
            }),
            "ground hull 0: its 4 points lie in one plane");
  EXPECT_EQ(refusal_after([](Scene& s) { s.meshes[0].triangles[2][1] = 99; }),
            "mesh 0: triangle 2: vertex 99 does not exist (the mesh has 12 vertices)");
  EXPECT_EQ(refusal_after([](Scene& s) { s.meshes[0].triangles[2][1] = s.meshes[0].triangles[2][0]; }),
            "mesh 0: triangle 2 has no area");
  EXPECT_EQ(refusal_after([](Scene& s) { s.meshes[0].surface.restitution = 2; }),
            "mesh 0: restitution must be from 0 to 1, got 2");
  EXPECT_NE(
      refusal_after([](Scene& s) { s.meshes[0].triangles.pop_back(); }).find("so that it encloses nothing"),
      std::string::npos);
  EXPECT_NE(refusal_after([](Scene& s) {
              s.meshes[0].triangles.push_back(s.meshes[0].triangles[0]);
            }).find("is the third at the edge"),
            std::string::npos);
  EXPECT_EQ(refusal_after([](Scene& s) {
              for (auto& triangle : s.meshes[0].triangles) std::swap(triangle[0], triangle[1]);
            }),
            "mesh 0: its triangles go clockwise as seen from outside");
  EXPECT_EQ(refusal_after([](Scene& s) { s.height_fields[0].heights.pop_back(); }),
            "height field 0: 3 heights are not two or more rows of 2");
  Scene hull;
  hull.hulls.push_back({.body = 0, .points = sound.ground_hulls[0].points});
  EXPECT_EQ(test::refusal([&] { validate_hulls(hull); }),
            "hull 0: body 0 does not exist (the scene has 0 bodies)");
}

// The distance from a box is that of its formula, however thin it is.
TEST(GroundShape, KnowsDistancesOfBoxes) {
  test::Random random(91);
  for (const double thickness : {0.3, 1e-9}) {
    const Vec3 half{0.5, thickness, 20};
    const GroundShape shape(box_at({}, half), 0);
    for (int round = 0; round < 300; ++round) {
      const Vec3 p = 2.0 * test::random_vector(random);
      const Vec3 out{std::max(std::abs(p.x) - half.x, 0.0), std::max(std::abs(p.y) - half.y, 0.0),
                     std::max(std::abs(p.z) - half.z, 0.0)};
      const double inside =
          std::max({std::abs(p.x) - half.x, std::abs(p.y) - half.y, std::abs(p.z) - half.z});
      EXPECT_NEAR(shape.distance(p), inside < 0 ? inside : norm(out), 1e-12);
    }
  }
}

// Over a floor of boxes a ball is kept off one plane, straight up, wherever it is. On one side is a wall,
// which also keeps it off.
TEST(GroundSearch, FloorsOfBoxesHaveNoEdges) {
  Scene scene;
  for (int i = -5; i <= 5; ++i)
    for (int k = -5; k <= 5; ++k)
      scene.boxes.push_back(box_at({0.2 * i + 0.03 * (k % 2), -0.1, 0.2 * k}, {0.1, 0.1, 0.1}));
  const auto wall = static_cast<std::uint32_t>(scene.boxes.size());
  scene.boxes.push_back(box_at({0.6, 0.5, 0}, {0.1, 0.5, 1}));  // its face is at x = 0.5
  const Surroundings around(scene);
  test::Random random(92);
  for (int round = 0; round < 500; ++round) {
    const double radius = round % 2 == 0 ? 0.1 : 0;
    const Vec3 at{0.35 * test::signed_unit(random) + 0.1, radius + 1e-4 * test::signed_unit(random),
                  0.6 * test::signed_unit(random)};
    int up = 0, aside = 0;
    Array<std::uint32_t> near;
    Bounds bounds = nowhere;
    include(bounds, at, 0.3);
    around.find(bounds, near);
    for (const std::uint32_t ground : near)
      for_end_touches(around, ground, {at, at, radius, 0.1}, 0, search,
                      [&](std::uint64_t, const Touch& touch) {
                        const bool is_wall = ground == wall;
                        (is_wall ? aside : up) += 1;
                        EXPECT_NEAR(norm(touch.normal - (is_wall ? Vec3{-1, 0, 0} : Vec3{0, 1, 0})), 0, 1e-9)
                            << at.x << " " << at.z;
                      });
    EXPECT_GE(up, 1);
    EXPECT_LE(up, 2) << "two boxes if it is over their seam";
    EXPECT_EQ(aside, 0.5 - at.x < radius + search.reach(0.1, radius) ? 1 : 0);
  }
}

// A line that lies over many boxes needs no place between its ends, and one over the edge of a box does.
TEST(GroundSearch, LinesTouchBetweenTheirEndsOnlyAtEdges) {
  for (const bool is_gap : {false, true}) {
    Scene scene;
    for (int i = 0; i < 6; ++i)
      if (!is_gap || i < 3) scene.boxes.push_back(box_at({0.2 * i, -0.1, 0}, {0.1, 0.1, 0.1}));
    const Surroundings around(scene);
    const MovingSegment line{{{0.02, 0.05, 0.01}, {0.93, 0.05, -0.02}, 0.05}, {}, {}};
    std::vector<double> places;
    for (std::uint32_t i = 0; i < around.shapes.size(); ++i)
      for_line_touches(around, i, line, 0, search, [&](std::uint64_t, const Touch& touch) {
        EXPECT_NEAR(touch.gap, 0, 1e-12);
        places.push_back(touch.a);
      });
    ASSERT_EQ(places.size(), is_gap ? 1u : 0u);
    if (is_gap) {
      EXPECT_NEAR(places[0], 0.48 / 0.91, 1e-9);
    }
  }
}

// A hull meets a spike with the middle of a face, where none of its edges is.
TEST(GroundSearch, HullsMeetSpikesWithTheirFaces) {
  Scene part;
  MassProperties mass = solid_box(1, {1, 0.2, 1});
  mass.center = {0, 2, 0};
  add_body(part, mass);
  part.hulls.push_back(box_on_body(0, box_at({0, 2, 0}, {0.5, 0.1, 0.5})));
  const Linkage linkage(part, Isa::scalar);
  Scene scene;
  scene.ground_hulls.push_back({.points = {{-0.1, 0, -0.1}, {0.1, 0, -0.1}, {0, 0, 0.1}, {0, 1, 0}}});
  const test::Mesh spike{scene.ground_hulls[0].points, {{0, 1, 2}, {0, 3, 1}, {1, 3, 2}, {2, 3, 0}}};
  scene.meshes.push_back({spike.vertices, spike.triangles, true, {}});
  ASSERT_EQ(test::refusal([&] { validate_ground(scene); }), "");
  const Surroundings around(scene);
  std::vector<Vec3> x;
  for (const Particle& each : part.particles) x.push_back(each.position);
  const Linkage::HullShape& shape = linkage.hulls()[0];
  PlacedHulls hulls;
  hulls.add(shape, shape.of(x));
  const Vec3 down{0, -3, 0};
  const MovingHullShape moving = hulls.moving(0, {down, down, down, down});
  for (const std::uint32_t ground : {0u, 1u}) {
    int found = 0;
    for_first_touches(around, ground, moving, {0, close},
                      [&](std::uint64_t, const Combination& at, const Touch& plane, double time) {
                        EXPECT_NEAR(time, 0.9 / 3, close);
                        EXPECT_NEAR(plane.gap, 0.9, 2 * close);
                        EXPECT_NEAR(norm(at.of(x) - Vec3{0, 1.9, 0}), 0, 1e-4);
                        EXPECT_TRUE(is_missed(plane, time, close));
                        ++found;
                      });
    EXPECT_EQ(found, 1);
  }
}

// All below a landscape is solid: a point far below it is told how far, and in which direction, it is.
TEST(GroundShape, HeightFieldsAreSolidBelow) {
  const GroundShape flat(
      HeightField{.corner = {-2, 3, -2}, .columns = 5, .heights = std::vector<double>(25)});
  for (const double depth : {0.01, 1.0, 500.0, 1e5})
    for (const double x : {-1.999, -1.5, 0.0, 0.25, 1.99}) {  // near a side, in a triangle, on an edge
      const Vec3 p{x, 3 - depth, 0.25};
      Bounds around = nowhere;
      include(around, p, 1e-3);
      EXPECT_TRUE(flat.reaches_into(around));
      LineTouches out;
      flat.touch_point(p, p, 1e-3, out);
      ASSERT_EQ(out.count, 1u) << x << " " << depth;
      EXPECT_NEAR(out.list[0].gap, -depth, 1e-9);
      EXPECT_NEAR(out.list[0].normal.y, 1, 1e-12);
    }
  for (const Vec3 p : {Vec3{0, 3.1, 0}, Vec3{2.1, 1, 0}, Vec3{0, 1, -2.1}}) {
    LineTouches out;
    flat.touch_point(p, p, 1e-3, out);
    EXPECT_EQ(out.count, 0u);
  }
}

}  // namespace
}  // namespace plumb::detail::PLUMB_TEST_FILE
