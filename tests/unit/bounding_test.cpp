#include "plumb/reference/bounding.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <string>
#include <utility>
#include <vector>

#include "plumb/error.hpp"
#include "support/random_trees.hpp"

namespace plumb::PLUMB_TEST_FILE {
namespace {

/// How far outside a point is, in m; not above zero inside. Of a mesh, that of the worst face.
double outside(const BoundingSphere& s, Vec3 p) {
  return norm(p - s.center) - s.radius;
}
double outside(const BoundingCylinder& c, Vec3 p) {
  const Vec3 r = p - c.center;
  return std::max(std::hypot(r.x, r.z) - c.radius, std::abs(r.y) - c.height / 2);
}
double outside(const Aabb& b, Vec3 p) {
  return std::max(
      {b.low.x - p.x, p.x - b.high.x, b.low.y - p.y, p.y - b.high.y, b.low.z - p.z, p.z - b.high.z});
}
double outside(const Obb& b, Vec3 p) {
  const Vec3 r = p - b.center;
  return std::max({std::abs(dot(b.axis[0], r)) - b.half_size.x, std::abs(dot(b.axis[1], r)) - b.half_size.y,
                   std::abs(dot(b.axis[2], r)) - b.half_size.z});
}
Vec3 unit_normal(const ConvexMesh& mesh, const std::array<std::uint32_t, 3>& face) {
  const Vec3 p = mesh.vertices[face[0]];
  const Vec3 normal = cross(mesh.vertices[face[1]] - p, mesh.vertices[face[2]] - p);
  return (1 / norm(normal)) * normal;
}
double outside(const ConvexMesh& mesh, Vec3 p) {
  double worst = -std::numeric_limits<double>::infinity();
  for (const auto& face : mesh.faces)
    worst = std::max(worst, dot(unit_normal(mesh, face), p - mesh.vertices[face[0]]));
  return worst;
}

Vec3 random_unit(test::Random& random) {
  const Vec3 v = test::random_vector(random) + Vec3{0.01, 0, 0};
  return (1 / norm(v)) * v;
}

struct Axes {
  Vec3 x, y, z;
};
Axes random_axes(test::Random& random) {
  const Vec3 x = random_unit(random);
  const Vec3 across = cross(x, random_unit(random));
  const Vec3 y = (1 / norm(across)) * across;
  return {x, y, cross(x, y)};
}

/// Random points in a box of random shape and place; of every third, on its surface alone.
std::vector<Vec3> random_cloud(test::Random& random, double spread = 2) {
  const auto [x, y, z] = random_axes(random);
  const Vec3 size = 0.6 * test::random_vector(random) + Vec3{0.7, 0.7, 0.7};
  const Vec3 center = spread * test::random_vector(random);
  const bool surface = test::below(random, 3) == 0;
  std::vector<Vec3> points;
  const std::uint32_t n = 8 + test::below(random, 40);
  for (std::uint32_t i = 0; i < n; ++i) {
    Vec3 p = test::random_vector(random);
    if (surface) p.x = p.x > 0 ? 1 : -1;
    points.push_back(center + (size.x * p.x) * x + (size.y * p.y) * y + (size.z * p.z) * z);
  }
  return points;
}

/// A random place between the corners of a cloud.
Vec3 random_mean(test::Random& random, const std::vector<Vec3>& points) {
  Vec3 sum;
  double weights = 0;
  for (const Vec3 p : points) {
    const double u = (1 + test::signed_unit(random)) / 2;
    const double weight = u * u * u * u;
    sum += weight * p;
    weights += weight;
  }
  return (1 / weights) * sum;
}

template <class Volume>
struct Make;
template <>
struct Make<BoundingSphere> {
  static BoundingSphere of(std::span<const Vec3> points) { return bounding_sphere_of(points); }
};
template <>
struct Make<BoundingCylinder> {
  static BoundingCylinder of(std::span<const Vec3> points) { return bounding_cylinder_of(points); }
};
template <>
struct Make<Aabb> {
  static Aabb of(std::span<const Vec3> points) { return aabb_of(points); }
};
template <>
struct Make<Obb> {
  static Obb of(std::span<const Vec3> points) { return obb_of(points); }
};
template <>
struct Make<ConvexMesh> {
  static ConvexMesh of(std::span<const Vec3> points) { return convex_mesh_of(points); }
};

template <class Volume>
class Bounding : public testing::Test {};
using Volumes = testing::Types<BoundingSphere, BoundingCylinder, Aabb, Obb, ConvexMesh>;
TYPED_TEST_SUITE(Bounding, Volumes);

// Tolerance: rounding; of a mesh, what its header promises.
TYPED_TEST(Bounding, HoldsItsPoints) {
  test::Random random(3);
  for (int round = 0; round < 100; ++round) {
    const std::vector<Vec3> points = random_cloud(random);
    const TypeParam volume = Make<TypeParam>::of(points);
    const double tolerance = std::is_same_v<TypeParam, ConvexMesh> ? 1e-9 : 1e-14;
    for (const Vec3 p : points) EXPECT_LE(outside(volume, p), tolerance);
  }
}

TYPED_TEST(Bounding, RefusesNoPointsAndBadOnes) {
  const auto refusal = [](const std::vector<Vec3>& points) -> std::string {
    try {
      Make<TypeParam>::of(points);
    } catch (const InputError& error) {
      return error.what();
    }
    return {};
  };
  EXPECT_EQ(refusal({}), "a bounding volume needs a point at least");
  EXPECT_EQ(refusal({{0, 0, 0}, {0, std::numeric_limits<double>::quiet_NaN(), 0}}),
            "point 1: position is not finite");
}

// A volume that shares a place with another overlaps it: places of one are tried in the other. Where none is
// found nothing follows, so the pairs that are apart are checked by shapes that are known below.
TYPED_TEST(Bounding, OverlapIsSymmetricAndFindsSharedPlaces) {
  test::Random random(4);
  int overlapping = 0, apart = 0;
  for (int round = 0; round < 400; ++round) {
    const std::vector<Vec3> a_points = random_cloud(random), b_points = random_cloud(random);
    const TypeParam a = Make<TypeParam>::of(a_points), b = Make<TypeParam>::of(b_points);
    const bool overlapped = overlap(a, b);
    EXPECT_EQ(overlap(b, a), overlapped);
    EXPECT_TRUE(overlap(a, a));
    ++(overlapped ? overlapping : apart);
    for (int sample = 0; sample < 100; ++sample) {
      const bool shared = outside(b, random_mean(random, a_points)) < -1e-9 ||
                          outside(a, random_mean(random, b_points)) < -1e-9;
      if (shared) {
        EXPECT_TRUE(overlapped);
      }
    }
  }
  EXPECT_GT(overlapping, 20);
  EXPECT_GT(apart, 20);
}

// A convex volume and its copy moved away overlap up to one distance and not beyond.
TYPED_TEST(Bounding, OverlapEndsWhereTheyPart) {
  test::Random random(6);
  for (int round = 0; round < 100; ++round) {
    const std::vector<Vec3> points = random_cloud(random, 0);
    const Vec3 way = random_unit(random);
    const TypeParam still = Make<TypeParam>::of(points);
    const auto moved_by = [&](double distance) {
      std::vector<Vec3> moved = points;
      for (Vec3& p : moved) p += distance * way;
      return Make<TypeParam>::of(moved);
    };
    EXPECT_FALSE(overlap(still, moved_by(20)));
    double touching = 0, parted = 20;
    while (parted - touching > 1e-6) {
      const double middle = (touching + parted) / 2;
      (overlap(still, moved_by(middle)) ? touching : parted) = middle;
    }
    for (double t = 0.05; t < 1; t += 0.1) {
      EXPECT_TRUE(overlap(still, moved_by(t * touching)));
      EXPECT_FALSE(overlap(still, moved_by(parted + t)));
    }
  }
}

TEST(BoundingSphere, IsAboutTheMean) {
  const BoundingSphere sphere = bounding_sphere_of(std::vector<Vec3>{{0, 0, 0}, {2, 0, 0}, {1, 3, 0}});
  EXPECT_EQ(sphere.center, (Vec3{1, 1, 0}));
  EXPECT_DOUBLE_EQ(sphere.radius, 2);
}

TEST(BoundingSphere, TouchesAtTheSumOfTheRadii) {
  const BoundingSphere a{{0, 0, 0}, 1}, b{{3, 0, 0}, 2};
  EXPECT_TRUE(overlap(a, b));
  EXPECT_FALSE(overlap(a, BoundingSphere{{3, 1e-7, 0}, 2 - 1e-9}));
}

TEST(BoundingCylinder, IsUprightAroundItsPoints) {
  const BoundingCylinder c =
      bounding_cylinder_of(std::vector<Vec3>{{1, 0, 0}, {-1, 0, 0}, {0, 5, 1}, {0, 5, -1}});
  EXPECT_EQ(c.center, (Vec3{0, 2.5, 0}));
  EXPECT_DOUBLE_EQ(c.radius, 1);
  EXPECT_DOUBLE_EQ(c.height, 5);
}

// Side by side by the distance over the ground, one above the other by their heights.
TEST(BoundingCylinder, OverlapsByGroundAndHeight) {
  const BoundingCylinder a{{0, 0, 0}, 1, 4};
  EXPECT_TRUE(overlap(a, {{1.9, 2.9, 0}, 1, 2}));
  EXPECT_FALSE(overlap(a, {{2.1, 0, 0}, 1, 2}));
  EXPECT_FALSE(overlap(a, {{0, 3.1, 0}, 1, 2}));
  EXPECT_FALSE(overlap(a, {{1.5, 0, 1.5}, 1, 2}));
}

TEST(Aabb, OverlapsOnAllThreeAxes) {
  const Aabb a{{0, 0, 0}, {1, 1, 1}};
  EXPECT_TRUE(overlap(a, {{1, 1, 1}, {2, 2, 2}}));
  EXPECT_FALSE(overlap(a, {{1.1, 0, 0}, {2, 1, 1}}));
  EXPECT_FALSE(overlap(a, {{0, -2, 0}, {1, -0.1, 1}}));
  EXPECT_FALSE(overlap(a, {{0, 0, 1.1}, {1, 1, 2}}));
  EXPECT_TRUE(overlap(a, {{0.4, 0.4, 0.4}, {0.6, 0.6, 0.6}})) << "inside";
}

TEST(Obb, FollowsWhatItHoldsAsItTurns) {
  test::Random random(7);
  for (int round = 0; round < 50; ++round) {
    const auto [x, y, z] = random_axes(random);
    std::vector<Vec3> corners;
    for (int i = 0; i < 8; ++i) {
      const double sx = i & 1 ? 1 : -1, sy = i & 2 ? 1 : -1, sz = i & 4 ? 1 : -1;
      corners.push_back(Vec3{1, 2, 3} + (0.1 * sx) * x + (0.5 * sy) * y + (2 * sz) * z);
    }
    const Obb box = obb_of(corners);
    EXPECT_LE(norm(box.center - Vec3{1, 2, 3}), 1e-13);
    EXPECT_LE(norm(box.half_size - Vec3{0.1, 0.5, 2}), 1e-13);
    EXPECT_NEAR(std::abs(dot(box.axis[2], z)), 1, 1e-13);
  }
}

// Two crossed beams whose edges pass each other: only the axis across both edges tells them apart.
TEST(Obb, CrossedBeamsAreToldApartByTheirEdges) {
  const double h = std::sqrt(0.5);
  const auto beam = [&](Vec3 center, bool along_x) {
    const Vec3 along = along_x ? Vec3{1, 0, 0} : Vec3{0, 0, 1},
               across = along_x ? Vec3{0, 0, 1} : Vec3{1, 0, 0};
    return Obb{.center = center,
               .axis = {along, h * (across + Vec3{0, 1, 0}), h * (Vec3{0, 1, 0} - across)},
               .half_size = {5, 1, 1}};
  };
  EXPECT_TRUE(overlap(beam({0, 0, 0}, true), beam({0, 2 * std::sqrt(2) - 1e-6, 0}, false)));
  EXPECT_FALSE(overlap(beam({0, 0, 0}, true), beam({0, 2 * std::sqrt(2) + 1e-6, 0}, false)));
}

TEST(Obb, InsideAnotherOverlapsIt) {
  const std::array<Vec3, 3> axes{Vec3{1, 0, 0}, {0, 1, 0}, {0, 0, 1}};
  EXPECT_TRUE(overlap(Obb{{}, axes, {5, 5, 5}}, Obb{{1, 1, 1}, axes, {0.1, 0.1, 0.1}}));
}

std::vector<Vec3> corners_of(const Obb& box) {
  std::vector<Vec3> corners;
  for (int i = 0; i < 8; ++i) {
    const double sx = i & 1 ? 1 : -1, sy = i & 2 ? 1 : -1, sz = i & 4 ? 1 : -1;
    corners.push_back(box.center + (sx * box.half_size.x) * box.axis[0] +
                      (sy * box.half_size.y) * box.axis[1] + (sz * box.half_size.z) * box.axis[2]);
  }
  return corners;
}

// Two algorithms, separating axes and distance, over the same shapes.
TEST(Obb, OverlapsAsTheMeshOfItsCornersDoes) {
  test::Random random(8);
  int overlapping = 0;
  for (int round = 0; round < 2000; ++round) {
    const Obb a = obb_of(random_cloud(random)), b = obb_of(random_cloud(random));
    overlapping += overlap(a, b);
    EXPECT_EQ(overlap(a, b), overlap(convex_mesh_of(corners_of(a)), convex_mesh_of(corners_of(b))));
  }
  EXPECT_GT(overlapping, 200);
  EXPECT_LT(overlapping, 1800);
}

/// By the separating axes of convex polyhedra: normals of faces and products of edges.
bool overlap_by_axes(const ConvexMesh& a, const ConvexMesh& b) {
  const auto separates = [&](Vec3 axis) {
    double a_high = -1e300, a_low = 1e300, b_high = -1e300, b_low = 1e300;
    for (const Vec3 p : a.vertices)
      a_high = std::max(a_high, dot(axis, p)), a_low = std::min(a_low, dot(axis, p));
    for (const Vec3 p : b.vertices)
      b_high = std::max(b_high, dot(axis, p)), b_low = std::min(b_low, dot(axis, p));
    return a_low > b_high || b_low > a_high;
  };
  for (const ConvexMesh* mesh : {&a, &b})
    for (const auto& face : mesh->faces)
      if (separates(unit_normal(*mesh, face))) return false;
  const auto edge = [](const ConvexMesh& mesh, const std::array<std::uint32_t, 3>& face, std::size_t k) {
    return mesh.vertices[face[(k + 1) % 3]] - mesh.vertices[face[k]];
  };
  for (const auto& f : a.faces)
    for (const auto& g : b.faces)
      for (std::size_t i = 0; i < 3; ++i)
        for (std::size_t j = 0; j < 3; ++j)
          if (separates(cross(edge(a, f, i), edge(b, g, j)))) return false;
  return true;
}

TEST(ConvexMesh, OverlapsAsSeparatingAxesSay) {
  test::Random random(9);
  int overlapping = 0;
  for (int round = 0; round < 150; ++round) {
    const ConvexMesh a = convex_mesh_of(random_cloud(random, 1)), b = convex_mesh_of(random_cloud(random, 1));
    const bool expected = overlap_by_axes(a, b);
    overlapping += expected;
    EXPECT_EQ(overlap(a, b), expected);
  }
  EXPECT_GT(overlapping, 30);
  EXPECT_LT(overlapping, 120);
}

// Boxes of many shapes, face to face, by far less or more than they touch by: where the direction between
// them is lost to rounding.
TEST(ConvexMesh, OverlapIsRightNextToTouching) {
  test::Random random(18);
  for (int round = 0; round < 2000; ++round) {
    const auto [x, y, z] = random_axes(random);
    const auto size = [&] { return std::pow(10, test::signed_unit(random)); };
    const Vec3 half{size(), size(), size()};
    const double gap =
        norm(half) * std::pow(10, -8 + 2 * test::signed_unit(random)) * (round % 2 == 0 ? 1 : -1);
    const Vec3 aside = test::signed_unit(random) * half.y * y + test::signed_unit(random) * half.z * z;
    const Obb a{{}, {x, y, z}, half}, b{(2 * half.x + gap) * x + aside, {x, y, z}, half};
    EXPECT_EQ(overlap(a, b), gap < 0);
    EXPECT_EQ(overlap(convex_mesh_of(corners_of(a)), convex_mesh_of(corners_of(b))), gap < 0) << gap;
  }
}

/// Closed, every edge between two faces, with Euler's V - E + F = 2, and convex with no vertex outside.
void expect_convex(const ConvexMesh& mesh, double tolerance) {
  std::map<std::pair<std::uint32_t, std::uint32_t>, int> edges;
  for (const auto& face : mesh.faces)
    for (std::size_t k = 0; k < 3; ++k) ++edges[{face[k], face[(k + 1) % 3]}];
  for (const auto& [edge, count] : edges) {
    EXPECT_EQ(count, 1);
    EXPECT_TRUE(edges.contains({edge.second, edge.first}));
  }
  EXPECT_EQ(mesh.vertices.size() + mesh.faces.size(), edges.size() / 2 + 2);
  for (const Vec3 p : mesh.vertices) EXPECT_LE(outside(mesh, p), tolerance);
}

TEST(ConvexMesh, IsClosedAndConvex) {
  test::Random random(10);
  for (int round = 0; round < 100; ++round) expect_convex(convex_mesh_of(random_cloud(random)), 1e-9);
}

// A lattice has its points in planes and in lines, and turned they are so only to rounding.
TEST(ConvexMesh, OfALatticeIsABox) {
  test::Random random(14);
  for (int round = 0; round < 50; ++round) {
    const auto [x, y, z] = random_axes(random);
    std::vector<Vec3> points;
    for (int i = 0; i < 5; ++i)
      for (int j = 0; j < 5; ++j)
        for (int k = 0; k < 5; ++k)
          points.push_back(Vec3{1, 1, 1} + (0.1 * i) * x + (0.7 * j) * y + (0.3 * k) * z);
    test::shuffle(points, random);
    const ConvexMesh mesh = convex_mesh_of(points);
    expect_convex(mesh, 1e-9);
    for (const Vec3 p : points) EXPECT_LE(outside(mesh, p), 1e-9);
    double volume = 0;
    for (const auto& face : mesh.faces)
      volume += dot(mesh.vertices[face[0]], cross(mesh.vertices[face[1]], mesh.vertices[face[2]])) / 6;
    EXPECT_NEAR(volume, 0.4 * 2.8 * 1.2, 1e-9);
  }
}

// All points of a sphere are corners.
TEST(ConvexMesh, OfASphereHasAllItsPoints) {
  test::Random random(15);
  std::vector<Vec3> points;
  for (int i = 0; i < 300; ++i) points.push_back(random_unit(random));
  const ConvexMesh mesh = convex_mesh_of(points);
  EXPECT_EQ(mesh.vertices.size(), 300u);
  EXPECT_EQ(mesh.faces.size(), 596u);
  expect_convex(mesh, 1e-9);
  points.insert(points.end(), points.begin(), points.end());
  EXPECT_EQ(convex_mesh_of(points).vertices.size(), 300u) << "every point twice";
}

TEST(ConvexMesh, RefusesPointsInAPlane) {
  test::Random random(16);
  for (int round = 0; round < 20; ++round) {
    const auto [x, y, z] = random_axes(random);
    std::vector<Vec3> points;
    for (int i = 0; i < 20; ++i)
      points.push_back(z + test::signed_unit(random) * x + test::signed_unit(random) * y);
    try {
      convex_mesh_of(points);
      FAIL() << "accepted points in a plane";
    } catch (const InputError& error) {
      EXPECT_STREQ(error.what(), "a convex mesh needs points that do not lie in one plane");
    }
  }
  EXPECT_THROW(convex_mesh_of(std::vector<Vec3>(5, Vec3{1, 2, 3})), InputError);
  EXPECT_THROW(convex_mesh_of(std::vector<Vec3>{{0, 0, 0}, {1, 1, 1}, {2, 2, 2}, {3, 3, 3}}), InputError);
}

// Thesis 2.4: the spheres first, then the boxes.
TEST(TwoLevelsOfVolumes, OverlapOnlyIfBothDo) {
  test::Random random(17);
  int spheres_alone = 0;
  for (int round = 0; round < 1000; ++round) {
    const TwoLevels a = two_levels_of(random_cloud(random)), b = two_levels_of(random_cloud(random));
    EXPECT_EQ(overlap_in_two_levels(a, b), overlap(a.sphere, b.sphere) && overlap(a.box, b.box));
    spheres_alone += overlap(a.sphere, b.sphere) && !overlap(a.box, b.box);
  }
  EXPECT_GT(spheres_alone, 50);
}

}  // namespace
}  // namespace plumb::PLUMB_TEST_FILE
