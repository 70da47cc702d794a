// Hulls on meshes: floors of triangles are planes to them too, and nothing is nearer than the least gap.

#include "contact/shapes/hulls/touch_hull.hpp"

#include <gtest/gtest.h>

#include <algorithm>

#include "contact/shapes/hulls/convex_hull.hpp"
#include "support/meshes.hpp"

namespace plumb::detail::PLUMB_TEST_FILE {
namespace {

using test::random_vector;

/// A tetrahedron or more, about `at`.
ConvexHull random_hull(test::Random& random, double size, Vec3 at) {
  std::vector<Vec3> points;
  const std::uint32_t count = 4 + test::below(random, 10);
  for (std::uint32_t i = 0; i < count; ++i) points.push_back(at + size * random_vector(random));
  return ConvexHull(points);
}

Vec3 middle_of(const ConvexHull& hull) {
  Vec3 sum{};
  for (const Vec3 v : hull.vertices()) sum += v;
  return (1.0 / static_cast<double>(hull.vertices().size())) * sum;
}

// Of a floor of triangles each low corner of a hull sees one plane, and edges see nothing.
TEST(TouchHull, FloorIsOnePlane) {
  test::Random random(71);
  const test::Mesh floor = test::shuffled_floor(40, 0.1, random);
  const TriangleMesh mesh(floor.vertices, floor.triangles, MeshSides::both);
  for (int round = 0; round < 500; ++round) {
    const ConvexHull hull = random_hull(random, 0.4, {test::signed_unit(random), 0.41, 0});
    const double reach = 0.2;
    const ConvexContacts found = contacts_of(hull.shape(0.01), middle_of(hull), mesh, reach);
    std::vector<double> gaps;
    for (const Vec3 v : hull.vertices())
      if (v.y - 0.01 <= reach) gaps.push_back(v.y - 0.01);
    std::sort(gaps.begin(), gaps.end());
    ASSERT_EQ(found.count, std::min<std::size_t>(gaps.size(), ConvexContacts::most));
    double least = INFINITY;
    for (const ConvexContact& each : found) {
      EXPECT_NEAR(each.gap, each.on_a.y - 0.01, 1e-15);
      EXPECT_NEAR(norm(each.normal - Vec3{0, 1, 0}), 0, 1e-12);
      least = std::min(least, each.gap);
    }
    if (!gaps.empty()) {
      EXPECT_NEAR(least, gaps[0], 1e-15);
    }
  }
}

// The least gap is the distance of the hull from all triangles.
TEST(TouchHull, LeastGapIsTheDistance) {
  test::Random random(72);
  test::Mesh hills = test::landscape(16, 0.12, [](double x, double z) { return 0.3 * x * z; });
  for (Vec3& v : hills.vertices) v.y += 0.08 * test::signed_unit(random);
  const TriangleMesh mesh(hills.vertices, hills.triangles, MeshSides::both);
  int compared = 0, corners = 0, edges = 0, peaks = 0;
  for (int round = 0; round < 1500; ++round) {
    const ConvexHull hull = random_hull(random, 0.3, Vec3{0, 0.3, 0} + 0.4 * random_vector(random));
    double least = INFINITY;
    for (std::uint32_t i = 0; i < mesh.size(); ++i) {
      const Triangle triangle = mesh.triangle(i);
      least = std::min(least, nearness(hull.shape(0), {.vertices = triangle, .normals = {}}).distance);
      if (least < 0) break;
    }
    if (!(least > 1e-6)) continue;
    const ConvexContacts found = contacts_of(hull.shape(0), middle_of(hull), mesh, least + 0.05);
    ASSERT_GT(found.count, 0u);
    ++compared;
    const ConvexContact& nearest =
        *std::min_element(found.begin(), found.end(),
                          [](const ConvexContact& a, const ConvexContact& b) { return a.gap < b.gap; });
    EXPECT_NEAR(nearest.gap, least, 1e-9);
    const std::uint64_t kind = nearest.key >> 62;
    corners += kind == 0, peaks += kind == 1, edges += kind == 2;
  }
  EXPECT_GT(compared, 300);
  EXPECT_GT(corners, 20);
  EXPECT_GT(edges, 20);
  EXPECT_GT(peaks, 20);
}

// A ridge that stands a little into the bottom of a box pushes it up, along its edge or its peak.
TEST(TouchHull, WhatStandsInAHullPushesItBack) {
  std::vector<Vec3> box;
  for (const double x : {-0.5, 0.5})
    for (const double y : {0.0, 0.4})
      for (const double z : {-0.5, 0.5}) box.push_back({x, y, z});
  const ConvexHull hull(box);
  // A roof whose ridge lies along x, longer than the box, at the height 0.01.
  const std::vector<Vec3> roof{{-2, 0.01, 0}, {2, 0.01, 0}, {-2, -1, -1},
                               {2, -1, -1},   {-2, -1, 1},  {2, -1, 1}};
  const std::vector<TriangleMesh::Corners> sides{{0, 1, 2}, {1, 3, 2}, {0, 4, 1}, {1, 4, 5}};
  const TriangleMesh ridge(roof, sides, MeshSides::both);
  const ConvexContacts over_ridge = contacts_of(hull.shape(0), {0, 0.2, 0}, ridge, 0.02);
  ASSERT_EQ(over_ridge.count, 2u);
  for (const ConvexContact& each : over_ridge) {
    EXPECT_NEAR(each.gap, -0.01, 1e-12);
    EXPECT_NEAR(each.normal.y, 1, 1e-12);
    EXPECT_NEAR(std::abs(each.on_a.x), 0.5, 1e-12);
  }
  const std::vector<Vec3> spike{{0.1, 0.01, 0.2}, {-1, -1, -1}, {1, -1, -1}, {0, -1, 1}};
  const std::vector<TriangleMesh::Corners> flanks{{0, 1, 2}, {0, 2, 3}, {0, 3, 1}};
  const TriangleMesh peak(spike, flanks, MeshSides::both);
  const ConvexContacts over_peak = contacts_of(hull.shape(0), {0, 0.2, 0}, peak, 0.02);
  ASSERT_EQ(over_peak.count, 1u);
  EXPECT_NEAR(over_peak.list[0].gap, -0.01, 1e-12);
  EXPECT_NEAR(over_peak.list[0].normal.y, 1, 1e-12);
}

// A prism of 80 corners and 120 edges in a crack of a landscape: no two contacts have one key, and those of
// its edges and of vertices keep theirs when others come.
TEST(TouchHull, KeysNameWhatTouches) {
  std::vector<Vec3> points;
  constexpr int around = 40;
  for (int i = 0; i < around; ++i) {
    const double angle = 6.283185307179586 * i / around;
    for (const double z : {-0.5, 0.5}) points.push_back({0.5 * std::cos(angle), 0.5 * std::sin(angle), z});
  }
  const ConvexHull hull(points);
  ASSERT_GT(hull.parts().edges.size(), 61u);
  test::Random random(73);
  for (int round = 0; round < 50; ++round) {
    test::Mesh hills = test::landscape(16, 0.12, [](double x, double) { return 0.5 * x * x; });
    for (Vec3& v : hills.vertices) v.y += 0.05 * test::signed_unit(random) - 0.52;
    const TriangleMesh mesh(hills.vertices, hills.triangles, MeshSides::both);
    std::vector<std::uint64_t> keys;
    std::vector<ConvexContact> few;
    for (const double reach : {0.02, 0.04}) {
      const ConvexContacts found = contacts_of(hull.shape(0), middle_of(hull), mesh, reach);
      keys.clear();
      for (const ConvexContact& each : found) keys.push_back(each.key);
      std::sort(keys.begin(), keys.end());
      EXPECT_EQ(std::adjacent_find(keys.begin(), keys.end()), keys.end());
      for (const ConvexContact& one : few)
        for (const ConvexContact& same : found)
          if (one.key >> 62 != 0 && norm(one.on_b - same.on_b) + norm(one.on_a - same.on_a) < 1e-12) {
            EXPECT_EQ(one.key, same.key);
          }
      few.assign(found.begin(), found.end());
    }
  }
}

}  // namespace
}  // namespace plumb::detail::PLUMB_TEST_FILE
