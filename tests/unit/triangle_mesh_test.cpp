// Triangles and meshes: what is nearest against samples and against all triangles, and floors that are
// planes.

#include "contact/shapes/meshes/triangle_mesh.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <set>

#include "contact/shapes/bounds.hpp"
#include "contact/shapes/bounds_tree.hpp"
#include "contact/shapes/meshes/touch_mesh.hpp"
#include "contact/shapes/meshes/triangle.hpp"
#include "scene/ground/weld.hpp"
#include "support/meshes.hpp"

namespace plumb::detail::PLUMB_TEST_FILE {
namespace {

using test::random_vector;

Triangle random_triangle(test::Random& random) {
  return {random_vector(random), random_vector(random), random_vector(random)};
}

/// The least distance of samples of a triangle from something; it exceeds the true one by less than 1/steps
/// of the longest edge.
template <class DistanceOf>
double sampled(const Triangle& t, int steps, DistanceOf distance_of) {
  double least = INFINITY;
  for (int i = 0; i <= steps; ++i)
    for (int k = 0; i + k <= steps; ++k) {
      const double u = double(i) / steps, v = double(k) / steps;
      least = std::min(least, distance_of(t[0] + u * (t[1] - t[0]) + v * (t[2] - t[0])));
    }
  return least;
}

double longest(const Triangle& t) {
  return std::max({norm(t[1] - t[0]), norm(t[2] - t[1]), norm(t[0] - t[2])});
}

TEST(Triangle, NearestPlaceIsNearestOfSamples) {
  test::Random random(31);
  std::set<TrianglePart> parts;
  for (int round = 0; round < 500; ++round) {
    const Triangle t = random_triangle(random);
    const Vec3 p = 1.5 * random_vector(random);
    const TrianglePlace place = nearest_on(t, p);
    const double found = norm(p - place.at);
    parts.insert(place.part);
    const double least = sampled(t, 40, [&](Vec3 at) { return norm(p - at); });
    EXPECT_LE(found, least + 1e-12);
    EXPECT_GE(found, least - longest(t) / 40);
    // It is on the part that it names: the way to p is at right angles to that.
    if (place.part == TrianglePart::face) {
      for (int k = 1; k < 3; ++k) EXPECT_NEAR(dot(p - place.at, t[k] - t[0]), 0, 1e-12);
    }
    const auto number = static_cast<std::size_t>(place.part);
    if (number < 3) {
      EXPECT_EQ(place.at, t[number]);
    }
    if (number >= 3 && number < 6) {
      const Vec3 edge = t[(number - 2) % 3] - t[number - 3];
      EXPECT_NEAR(dot(p - place.at, edge), 0, 1e-12);
      EXPECT_NEAR(norm(cross(place.at - t[number - 3], edge)), 0, 1e-12);
    }
  }
  EXPECT_EQ(parts.size(), 7u);
}

TEST(Triangle, SegmentIsNearestOfSamples) {
  test::Random random(32);
  int crossing = 0;
  for (int round = 0; round < 300; ++round) {
    const Triangle t = random_triangle(random);
    const Vec3 p = random_vector(random), q = random_vector(random);
    const SegmentToTriangle near = nearest_on(t, p, q);
    double least = INFINITY;
    for (int i = 0; i <= 200; ++i)
      least = std::min(least, norm(nearest_on(t, between(p, q, i / 200.0)).at - between(p, q, i / 200.0)));
    EXPECT_LE(near.distance, least + 1e-12);
    EXPECT_GE(near.distance, least - norm(q - p) / 400);
    EXPECT_NEAR(norm(near.on_segment - near.on_triangle), near.distance, 1e-12);
    EXPECT_NEAR(norm(nearest_on(t, near.on_triangle).at - near.on_triangle), 0, 1e-12);
    crossing += near.distance == 0;
    EXPECT_EQ(near.distance == 0, crosses(t, p, q));
  }
  EXPECT_GT(crossing, 10);
}

Bounds random_box(test::Random& random, double size) {
  Bounds out = nowhere;
  const Vec3 at = 5.0 * random_vector(random);
  include(out, at, 0);
  include(out, at + size * random_vector(random), 0);
  return out;
}

TEST(Bounds, DistancesAreThoseOfNearestCorners) {
  const Bounds box{{0, 0, 0}, {1, 2, 3}};
  EXPECT_EQ(distance2(box, {-3, 6, 1}), 25);
  EXPECT_EQ(distance2(box, {0.5, 1, 2}), 0);
  EXPECT_EQ(distance(box, {{2, 0, 0}, {3, 1, 1}}), 1);
  EXPECT_TRUE(nowhere.is_empty());
}

// Every box that overlaps is found once, and not all others are.
TEST(BoundsTree, FindsAllThatOverlap) {
  test::Random random(33);
  std::vector<Bounds> boxes;
  for (int i = 0; i < 1000; ++i) boxes.push_back(random_box(random, 0.5));
  const BoundsTree tree(boxes);
  std::size_t found = 0, overlapping = 0;
  for (int round = 0; round < 200; ++round) {
    const Bounds query = random_box(random, 4);
    std::vector<int> times(boxes.size());
    tree.find(query, [&](std::uint32_t i) { ++times[i]; });
    const auto any = [](int n) { return n > 0; };
    EXPECT_EQ(tree.reaches_into(query), std::any_of(times.begin(), times.end(), any));
    for (std::size_t i = 0; i < boxes.size(); ++i) {
      EXPECT_LE(times[i], 1);
      EXPECT_TRUE(times[i] == 1 || !boxes[i].overlaps(query));
      found += times[i] == 1;
      overlapping += boxes[i].overlaps(query);
    }
  }
  EXPECT_GT(overlapping, 1000u);
  EXPECT_LT(found, 4 * overlapping);
  BoundsTree().find(boxes[0], [](std::uint32_t) { ADD_FAILURE() << "nothing is there"; });
}

// Distances to 10,000 equal boxes ask few of them: about log n.
TEST(BoundsTree, NearestAsksFew) {
  test::Random random(34);
  std::vector<Bounds> boxes;
  for (int i = 0; i < 10000; ++i) boxes.push_back(random_box(random, 0.05));
  const BoundsTree tree(boxes);
  int asked = 0;
  for (int round = 0; round < 100; ++round) {
    const Vec3 p = 6.0 * random_vector(random);
    const double found = tree.find_nearest(p, INFINITY, [&](std::uint32_t i) {
      ++asked;
      return distance2(boxes[i], p);
    });
    double least = INFINITY;
    for (const Bounds& box : boxes) least = std::min(least, distance2(box, p));
    EXPECT_EQ(found, least);
  }
  EXPECT_LT(asked, 100 * 60);
}

TriangleMesh mesh_of(const test::Mesh& mesh, MeshSides sides) {
  return {mesh.vertices, mesh.triangles, sides};
}

void touch_segment(const TriangleMesh& mesh, Vec3 p, Vec3 q, double reach, LineTouches& out) {
  touch_mesh(mesh, p, 0.5 * (p + q), reach, 0, out);
  touch_mesh(mesh, q, 0.5 * (p + q), reach, 1, out);
  touch_mesh_between(mesh, p, q, reach, out);
}

test::Mesh hills(std::uint32_t cells, test::Random& random) {
  test::Mesh out = test::landscape(cells, 0.1, [](double x, double z) { return 0.3 * x * z; });
  for (Vec3& v : out.vertices) v.y += 0.05 * test::signed_unit(random);
  return out;
}

TEST(TriangleMesh, NearestIsThatOfAllTriangles) {
  test::Random random(35);
  const TriangleMesh mesh = mesh_of(hills(20, random), MeshSides::both);
  for (int round = 0; round < 300; ++round) {
    const Vec3 p = random_vector(random);
    double least = INFINITY;
    for (std::uint32_t i = 0; i < mesh.size(); ++i)
      least = std::min(least, norm(p - nearest_on(mesh.triangle(i), p).at));
    const auto found = mesh.nearest(p, 10);
    EXPECT_EQ(found.distance, least);
    EXPECT_EQ(mesh.nearest(p, 0.99 * least).triangle, TriangleMesh::none);
    // The nearest place of all faces what it is nearest to.
    const Vec3 n = (1 / least) * (p - found.place.at);
    EXPECT_TRUE(mesh.faces(mesh.part(found.triangle, found.place.part), n));
  }
}

// Whether the L encloses a point follows from the nearest place, at concave edges and corners too.
TEST(TriangleMesh, KnowsWhatItEncloses) {
  test::Random random(36);
  const TriangleMesh mesh = mesh_of(test::l_shape(), MeshSides::outward);
  int inside = 0;
  for (int round = 0; round < 2000; ++round) {
    const Vec3 p = Vec3{1, 1, 0.5} + 1.2 * random_vector(random);
    const auto found = mesh.nearest(p, 10);
    const Vec3 n = (1 / found.distance) * (p - found.place.at);
    const bool in = mesh.leads_inside(mesh.part(found.triangle, found.place.part), n);
    EXPECT_EQ(in, test::is_in_l(p)) << p.x << ' ' << p.y << ' ' << p.z;
    inside += in;
  }
  EXPECT_GT(inside, 100);
}

// Triangles without common vertices, as files of soups of triangles have them, hang together all the same.
TEST(TriangleMesh, WeldsVerticesInOnePlace) {
  test::Random random(37);
  const test::Mesh floor = test::shuffled_floor(4, 1, random);
  test::Mesh soup;
  for (const auto& triangle : floor.triangles) {
    const auto first = static_cast<std::uint32_t>(soup.vertices.size());
    for (const std::uint32_t corner : triangle) soup.vertices.push_back(floor.vertices[corner]);
    soup.triangles.push_back({first, first + 1, first + 2});
  }
  const TriangleMesh mesh = mesh_of(soup, MeshSides::both);
  const TriangleMesh::Edge& inner = mesh.edge(mesh.edges_of(0)[2]);
  EXPECT_NE(inner.triangle[1], TriangleMesh::none);
  EXPECT_TRUE(inner.is_flat);
}

// Wherever a point is above a floor of triangles, the floor is one plane to it.
TEST(TouchMesh, FloorIsOnePlaneToPoints) {
  test::Random random(38);
  const test::Mesh floor = test::shuffled_floor(40, 0.1, random);
  const TriangleMesh mesh = mesh_of(floor, MeshSides::both);
  for (int round = 0; round < 4000; ++round) {
    Vec3 p = 1.5 * random_vector(random);
    p.y = 0.1 * std::abs(p.y) + 1e-6;
    if (round % 4 == 0) {  // exactly above a vertex or an edge
      const auto& corners = floor.triangles[test::below(random, 3200)];
      const double t = round % 8 == 0 ? 0 : 0.25;
      const Vec3 at = between(floor.vertices[corners[0]], floor.vertices[corners[1]], t);
      p.x = at.x, p.z = at.z;
    }
    if (std::abs(p.x) > 1.8 || std::abs(p.z) > 1.8) continue;
    LineTouches found;
    touch_mesh(mesh, p, p, 0.3, 0, found);
    ASSERT_EQ(found.count, 1u);
    EXPECT_NEAR(found.list[0].gap, p.y, 1e-15);
    EXPECT_NEAR(norm(found.list[0].normal - Vec3{0, 1, 0}), 0, 1e-8);
  }
}

// A segment above the floor is kept off it at its ends, and nowhere else.
TEST(TouchMesh, FloorIsOnePlaneToSegments) {
  test::Random random(39);
  const TriangleMesh mesh = mesh_of(test::shuffled_floor(40, 0.1, random), MeshSides::both);
  for (int round = 0; round < 1000; ++round) {
    Vec3 p = 1.5 * random_vector(random), q = 1.5 * random_vector(random);
    p.y = 0.05 * std::abs(p.y), q.y = round % 3 == 0 ? p.y : 0.05 * std::abs(q.y);
    LineTouches found;
    touch_segment(mesh, p, q, 0.1, found);
    ASSERT_EQ(found.count, 2u);
    for (const LineTouch& touch : found) {
      EXPECT_NEAR(touch.gap, touch.at == 0 ? p.y : q.y, 1e-15);
      EXPECT_NEAR(norm(touch.normal - Vec3{0, 1, 0}), 0, 1e-8);
    }
  }
}

// Of all touches of a segment the nearest is its distance from the mesh, if that is not crossed.
TEST(TouchMesh, NearestTouchIsTheDistance) {
  test::Random random(40);
  const TriangleMesh mesh = mesh_of(hills(12, random), MeshSides::both);
  int compared = 0;
  for (int round = 0; round < 1000; ++round) {
    const Vec3 p = 0.8 * random_vector(random), q = p + 0.4 * random_vector(random);
    double least = INFINITY;
    for (std::uint32_t i = 0; i < mesh.size(); ++i)
      least = std::min(least, nearest_on(mesh.triangle(i), p, q).distance);
    if (least == 0) continue;
    LineTouches found;
    touch_segment(mesh, p, q, least + 0.05, found);
    double nearest = INFINITY;
    for (const LineTouch& touch : found) nearest = std::min(nearest, touch.gap);
    EXPECT_NEAR(nearest, least, 1e-9);
    ++compared;
  }
  EXPECT_GT(compared, 500);
}

// An open mesh pushes back to the side of the middle; a solid pushes out, from wherever inside.
TEST(TouchMesh, PushesToTheRightSide) {
  test::Random random(41);
  const TriangleMesh floor = mesh_of(test::shuffled_floor(10, 0.3, random), MeshSides::both);
  for (const double side : {1.0, -1.0}) {
    LineTouches found;
    touch_mesh(floor, {0, -0.01 * side, 0}, {0.1, 0.2 * side, 0.1}, 0.1, 0, found);
    ASSERT_EQ(found.count, 1u);
    EXPECT_NEAR(found.list[0].gap, -0.01, 1e-12);
    EXPECT_NEAR(found.list[0].normal.y, side, 1e-12);
  }
  const TriangleMesh solid = mesh_of(test::l_shape(), MeshSides::outward);
  for (int round = 0; round < 500; ++round) {
    const Vec3 p = Vec3{1, 1, 0.5} + 1.2 * random_vector(random);
    if (!test::is_in_l(p)) continue;
    LineTouches found;
    touch_mesh(solid, p, p, 1e-3, 0, found);
    ASSERT_EQ(found.count, 1u);
    EXPECT_NEAR(found.list[0].gap, -solid.nearest(p, 10).distance, 1e-12);
    const Vec3 out = p + (1e-6 - found.list[0].gap) * found.list[0].normal;
    EXPECT_FALSE(test::is_in_l(out));
  }
}

// A list that is full keeps the narrowest gaps.
TEST(TouchMesh, FullListsKeepTheNarrowest) {
  LineTouches list;
  for (std::uint32_t i = 0; i < 100; ++i) list.add({.gap = double((i * 37) % 100)});
  EXPECT_EQ(list.count, LineTouches::most);
  for (const LineTouch& touch : list) EXPECT_LT(touch.gap, LineTouches::most);
}

// Vertices with equal coordinates are one: the first of them. Zero has two signs.
TEST(Weld, NamesTheFirstInEachPlace) {
  const std::vector<Vec3> vertices = {
      {1, 2, 3}, {0, 0, 0}, {1, 2, 3}, {1, 2, 3.0000000000000004}, {0, 0, -0.0}};
  EXPECT_EQ(weld(vertices), (Array<std::uint32_t>{0, 1, 0, 3, 1}));
  EXPECT_TRUE(weld({}).empty());
}

// A capsule lies over the ridge of a roof, an open mesh. A line from its middle to an end pierces the roof
// twice or not at all, so that the end is on the middle's side and is kept off its own slope.
TEST(TouchMesh, LinesThatPierceARidgeTwiceAreOnOneSide) {
  const std::vector<Vec3> roof{{-3, 0, 0}, {3, 0, 0}, {-3, -1, -1}, {3, -1, -1}, {-3, -1, 1}, {3, -1, 1}};
  const std::vector<TriangleMesh::Corners> sides{{0, 1, 2}, {1, 3, 2}, {0, 4, 1}, {1, 4, 5}};
  const TriangleMesh mesh(roof, sides, MeshSides::both);
  const Vec3 up = (1 / std::sqrt(2.0)) * Vec3{0, 1, 1};
  for (const double x : {0.3, 0.7, -0.4})
    for (const double reach : {0.1, 2.0}) {  // the second sees the other slope, too
      const Vec3 end{x, -0.25, 0.3}, middle{x, -0.15, -0.2};
      LineTouches out;
      touch_mesh(mesh, end, middle, reach, 1, out);
      const auto own = std::find_if(
          out.begin(), out.end(), [&](const LineTouch& touch) { return dot(touch.normal, up) > 1 - 1e-12; });
      ASSERT_NE(own, out.end());
      EXPECT_NEAR(own->gap, dot(up, end), 1e-15);
      for (const LineTouch& touch : out) EXPECT_GT(touch.gap, 0);
    }
  // What is below the roof is on the other side, also where the line goes through an edge between triangles.
  for (const Vec3 end : {Vec3{0.2, -0.35, 0.3}, Vec3{0, -0.52, 0.48}}) {
    LineTouches out;
    touch_mesh(mesh, end, end + 0.2 * Vec3{0, 1, 1}, 0.1, 1, out);
    ASSERT_EQ(out.count, 1u);
    EXPECT_NEAR(out.list[0].gap, dot(up, end), 1e-15);
    EXPECT_LT(out.list[0].gap, 0);
  }
}

}  // namespace
}  // namespace plumb::detail::PLUMB_TEST_FILE
