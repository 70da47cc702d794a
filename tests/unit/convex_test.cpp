// Convex hulls, and where two of them are nearest: proved by a plane between them, not by another search.

#include "contact/shapes/hulls/convex.hpp"

#include <gtest/gtest.h>

#include <algorithm>

#include "contact/shapes/hulls/convex_hull.hpp"
#include "contact/shapes/hulls/simplex.hpp"
#include "support/random_trees.hpp"
#include "support/refusals.hpp"

namespace plumb::detail::PLUMB_TEST_FILE {
namespace {

using test::random_vector;

std::vector<Vec3> random_points(test::Random& random, std::size_t count, Vec3 at) {
  std::vector<Vec3> out;
  for (std::size_t i = 0; i < count; ++i) out.push_back(at + random_vector(random));
  return out;
}

std::vector<Vec3> box_points(Vec3 half, Vec3 at = {}) {
  std::vector<Vec3> out;
  for (const double x : {-half.x, half.x})
    for (const double y : {-half.y, half.y})
      for (const double z : {-half.z, half.z}) out.push_back(at + Vec3{x, y, z});
  return out;
}

/// How far a point is outside of all faces' planes at most.
double outside(const Convex& shape, Vec3 p) {
  double most = -INFINITY;
  for (std::uint32_t i = 0; i < shape.faces(); ++i)
    most = std::max(most, dot(shape.normals[i], p - shape.vertices[shape.parts->face(i)[0]]));
  return most;
}

void expect_sound(const ConvexHull& hull, std::span<const Vec3> points) {
  const Convex shape = hull.shape(0);
  const ConvexParts& parts = hull.parts();
  EXPECT_EQ(hull.vertices().size() + parts.faces(), parts.edges.size() + 2) << "Euler";
  for (const Vec3 p : points) EXPECT_LE(outside(shape, p), 1e-9);
  for (std::uint32_t i = 0; i < parts.faces(); ++i)
    for (const std::uint32_t corner : parts.face(i))
      EXPECT_NEAR(dot(shape.normals[i], shape.vertices[corner] - shape.vertices[parts.face(i)[0]]), 0, 1e-8);
  for (const ConvexParts::Edge& edge : parts.edges) {
    const Vec3 along = shape.vertices[edge.b] - shape.vertices[edge.a];
    EXPECT_GT(dot(cross(shape.normals[edge.left], shape.normals[edge.right]), along), 0) << "convex";
  }
  for (std::size_t i = 0; i < hull.vertices().size(); ++i)
    EXPECT_EQ(hull.vertices()[i], points[hull.numbers()[i]]);
}

TEST(ConvexHull, HoldsItsPoints) {
  test::Random random(61);
  for (int round = 0; round < 50; ++round) {
    const auto points = random_points(random, 4 + test::below(random, 100), {});
    const ConvexHull hull(points);
    ASSERT_FALSE(hull.is_empty());
    expect_sound(hull, points);
  }
}

// Points whose distances from common planes are about as large as the rounding that joins faces: hulls stay
// closed, or are refused by name.
TEST(ConvexHull, NoisyGridsAreClosedOrRefused) {
  test::Random random(62);
  int built = 0, rounds = 0;
  for (const double noise : {1e-12, 1e-11, 1e-10, 3e-10, 1e-9, 1e-8})
    for (int round = 0; round < 200; ++round, ++rounds) {
      std::vector<Vec3> points;
      const std::uint32_t sides = 2 + test::below(random, 2), count = 12 + test::below(random, 50);
      const auto place = [&] { return static_cast<double>(test::below(random, sides)); };
      for (std::uint32_t i = 0; i < count; ++i) {
        const double x = place(), y = place(), z = place();
        points.push_back(Vec3{x, y, z} + noise * random_vector(random));
      }
      const std::string refusal = test::refusal([&] {
        const ConvexHull hull(points);
        built += !hull.is_empty();
        EXPECT_TRUE(hull.is_empty() ||
                    hull.vertices().size() + hull.parts().faces() == hull.parts().edges.size() + 2)
            << "Euler";
      });
      EXPECT_TRUE(refusal.empty() || refusal.find("leaves its surface open") != std::string::npos) << refusal;
    }
  EXPECT_GT(built, rounds - rounds / 100);
}

// Points along edges, on faces and twice make no corners.
TEST(ConvexHull, GridsAreBoxes) {
  std::vector<Vec3> points;
  for (int x = 0; x < 4; ++x)
    for (int y = 0; y < 4; ++y)
      for (int z = 0; z < 4; ++z) points.push_back({0.1 * x, 0.3 * y, 0.7 * z});
  points.push_back(points[5]);
  const ConvexHull hull(points);
  expect_sound(hull, points);
  EXPECT_EQ(hull.vertices().size(), 8u);
  EXPECT_EQ(hull.parts().faces(), 6u);
  EXPECT_EQ(hull.parts().edges.size(), 12u);
  EXPECT_EQ(hull.bounds().high, (Vec3{0.1 * 3, 0.3 * 3, 0.7 * 3}));
}

TEST(ConvexHull, OfFlatPointsIsEmpty) {
  test::Random random(62);
  auto points = random_points(random, 20, {});
  EXPECT_TRUE(ConvexHull(std::span(points).first(3)).is_empty());
  for (Vec3& p : points) p.z = 0.5 * p.x;
  EXPECT_TRUE(ConvexHull(points).is_empty());
  for (Vec3& p : points) p = {p.x, 2 * p.x, 3 * p.x};
  EXPECT_TRUE(ConvexHull(points).is_empty());
  EXPECT_TRUE(ConvexHull(std::vector<Vec3>(9)).is_empty());
}

// Normals of a hull that was turned are its normals, turned.
TEST(ConvexHull, NormalsFollow) {
  const auto points = box_points({1, 2, 3});
  const ConvexHull hull(points);
  std::vector<Vec3> moved;
  for (const Vec3 v : hull.vertices()) moved.push_back({-v.y + 5, v.x, v.z});
  std::vector<Vec3> normals(hull.parts().faces());
  find_normals(hull.parts(), moved, normals);
  for (std::size_t i = 0; i < normals.size(); ++i) {
    const Vec3 n = hull.shape(0).normals[i];
    EXPECT_NEAR(norm(normals[i] - Vec3{-n.y, n.x, n.z}), 0, 1e-15);
  }
}

// Every place among samples of a simplex is farther from the origin than the one that is found.
TEST(Simplex, NearestPlaceIsNearestOfSamples) {
  test::Random random(63);
  int within = 0;
  for (int round = 0; round < 2000; ++round) {
    Simplex simplex;
    simplex.count = 2 + test::below(random, 3);
    for (std::uint32_t i = 0; i < simplex.count; ++i) simplex.points[i] = random_vector(random);
    const Simplex whole = simplex;
    if (!reduce_to_nearest(simplex)) {
      ++within;
      EXPECT_EQ(simplex.count, 4u);
      continue;
    }
    double sum = 0;
    for (std::uint32_t i = 0; i < simplex.count; ++i) {
      EXPECT_GE(simplex.weights[i], 0);
      sum += simplex.weights[i];
    }
    EXPECT_NEAR(sum, 1, 1e-12);
    const Vec3 v = simplex.place();
    for (std::uint32_t i = 0; i < whole.count; ++i) EXPECT_GE(dot(v, whole.points[i] - v), -1e-9);
  }
  EXPECT_GT(within, 20);
}

/// Distance of the planes at right angles to n that touch both shapes: b's below, a's above.
double plane_gap(const Convex& a, const Convex& b, Vec3 n) {
  double low = INFINITY, high = -INFINITY;
  for (const Vec3 v : a.vertices) low = std::min(low, dot(n, v));
  for (const Vec3 v : b.vertices) high = std::max(high, dot(n, v));
  return low - high;
}

/// A point, a segment, or a hull, somewhere.
struct Thing {
  Thing(test::Random& random, std::uint32_t kind)
      : points(random_points(random, kind < 2 ? kind + 1 : 4 + test::below(random, 20),
                             1.8 * random_vector(random))) {
    if (kind >= 2) hull = ConvexHull(points);
  }
  Convex shape() const {
    return hull.is_empty() ? Convex{.vertices = points, .normals = {}, .radius = 0} : hull.shape(0);
  }
  std::vector<Vec3> points;
  ConvexHull hull;
};

// Two places, one in each shape, are as far apart as a pair of planes between both: nothing is nearer.
TEST(Nearness, OfShapesApartIsProvedByAPlane) {
  test::Random random(64);
  int apart = 0, overlapping = 0;
  for (int round = 0; round < 6000; ++round) {
    const Thing one(random, test::below(random, 3)), two(random, test::below(random, 3));
    const Convex a = one.shape(), b = two.shape();
    const Nearness near = nearness(a, b);
    EXPECT_NEAR(norm(near.normal), 1, 1e-12);
    if (near.distance < 0) {
      ++overlapping;
      continue;
    }
    ++apart;
    EXPECT_NEAR(norm(near.on_a - near.on_b - near.distance * near.normal), 0, 1e-12);
    EXPECT_NEAR(plane_gap(a, b, near.normal), near.distance, 1e-9);
    // Shapes without faces are outside of none.
    EXPECT_LE(outside(a, near.on_a), 1e-9);
    EXPECT_LE(outside(b, near.on_b), 1e-9);
  }
  EXPECT_GT(apart, 2000);
  EXPECT_GT(overlapping, 50);
}

// Shapes that overlap come apart along the normal, and along no direction on a shorter way, to 2 %.
TEST(Nearness, OfOverlapIsTheShortestWayOut) {
  test::Random random(65);
  int compared = 0;
  for (int round = 0; round < 3000; ++round) {
    const Thing one(random, 2), two(random, 1 + test::below(random, 2));
    const Convex a = one.shape(), b = two.shape();
    const Nearness near = nearness(a, b);
    if (near.distance >= 0) continue;
    ++compared;
    EXPECT_NEAR(plane_gap(a, b, near.normal), near.distance, 1e-12);
    for (int k = 0; k < 50; ++k) {
      const Vec3 n = random_vector(random);
      EXPECT_LE(plane_gap(a, b, (1 / norm(n)) * n), 0.98 * near.distance);
    }
    std::vector<Vec3> moved;
    for (const Vec3 v : a.vertices) moved.push_back(v - (near.distance - 1e-6) * near.normal);
    const double apart = nearness({moved, a.normals, a.parts, 0}, b).distance;
    EXPECT_GT(apart, 1e-6 - 1e-9);
    EXPECT_LT(apart, 1e-6 - 0.02 * near.distance);
  }
  EXPECT_GT(compared, 300);
}

const ConvexContact& nearest_of(const ConvexContacts& contacts) {
  return *std::min_element(contacts.begin(), contacts.end(),
                           [](const ConvexContact& a, const ConvexContact& b) { return a.gap < b.gap; });
}

void expect_between(const ConvexContacts& contacts, double radii) {
  for (const ConvexContact& each : contacts)
    EXPECT_NEAR(norm(each.on_a - each.on_b - (each.gap + radii) * each.normal), 0, 1e-12);
}

// The contact of least gap is as near as the shapes are, whatever lies between which parts.
TEST(ConvexContacts, LeastGapIsTheDistance) {
  test::Random random(66);
  int touching = 0;
  for (int round = 0; round < 3000; ++round) {
    const Thing one(random, test::below(random, 3)), two(random, test::below(random, 3));
    Convex a = one.shape(), b = two.shape();
    a.radius = 0.1, b.radius = 0.2;
    const Nearness near = nearness(a, b);
    const ConvexContacts found = contacts_of(a, b, 0.5);
    expect_between(found, 0.3);
    EXPECT_EQ(found.count > 0, near.distance - 0.3 <= 0.5);
    if (found.count == 0 || near.distance < 0) continue;
    ++touching;
    EXPECT_NEAR(nearest_of(found).gap, near.distance - 0.3, 1e-5);
  }
  EXPECT_GT(touching, 300);
}

ConvexContacts on_slab(std::span<const Vec3> vertices, double reach) {
  const auto slab = box_points({5, 1, 5}, {0, -1, 0});
  const ConvexHull top(vertices), bottom(slab);
  return contacts_of(top.shape(0), bottom.shape(0), reach);
}

TEST(ConvexContacts, OfBoxesOnASlab) {
  auto box = box_points({0.3, 0.2, 0.4}, {0, 0.201, 0});
  const ConvexContacts flat = on_slab(box, 0.01);
  ASSERT_EQ(flat.count, 4u);
  for (const ConvexContact& each : flat) {
    EXPECT_NEAR(each.gap, 1e-3, 1e-12);
    EXPECT_EQ(each.normal, (Vec3{0, 1, 0}));
    EXPECT_NEAR(std::abs(each.on_a.x), 0.3, 1e-12);
    EXPECT_NEAR(std::abs(each.on_a.z), 0.4, 1e-12);
  }
  // On an edge, turned by 45 degrees about z, it stands on two corners; on a corner, on one.
  for (Vec3& v : box) v = {std::sqrt(0.5) * (v.x - v.y), std::sqrt(0.5) * (v.x + v.y), v.z};
  for (Vec3& v : box) v.y += 0.5;
  double least = INFINITY;
  for (const Vec3 v : box) least = std::min(least, v.y);
  const ConvexContacts edge = on_slab(box, least + 0.01);
  EXPECT_EQ(edge.count, 2u);
  for (Vec3& v : box) v = {v.x, std::sqrt(0.5) * (v.y - v.z), std::sqrt(0.5) * (v.y + v.z)};
  for (Vec3& v : box) v.y += 1;
  least = INFINITY;
  for (const Vec3 v : box) least = std::min(least, v.y);
  const ConvexContacts corner = on_slab(box, least + 0.01);
  ASSERT_EQ(corner.count, 1u);
  EXPECT_NEAR(corner.list[0].gap, least, 1e-12);
}

// A cube on another that is turned by 45 degrees has eight corners in common with it, and keeps their keys as
// it moves a little.
TEST(ConvexContacts, TurnedCubesHaveEight) {
  auto cube = box_points({0.5, 0.5, 0.5}, {0, 1.01, 0}), turned = box_points({0.5, 0.5, 0.5});
  for (Vec3& v : turned) v = {std::sqrt(0.5) * (v.x - v.z), v.y, std::sqrt(0.5) * (v.x + v.z)};
  const ConvexHull bottom(turned);
  std::vector<std::uint32_t> before;
  for (const double by : {0.0, 0.01}) {
    for (Vec3& v : cube) v.x += by;
    const ConvexHull top(cube);
    const ConvexContacts found = contacts_of(top.shape(0), bottom.shape(0), 0.1);
    ASSERT_EQ(found.count, 8u);
    std::vector<std::uint32_t> keys;
    for (const ConvexContact& each : found) keys.push_back(each.key);
    std::sort(keys.begin(), keys.end());
    EXPECT_EQ(std::adjacent_find(keys.begin(), keys.end()), keys.end());
    if (by == 0) before = keys;
    EXPECT_EQ(keys, before);
  }
}

// A cube on one that is as wide touches at its own corners, whichever way rounding moves or turns it. As it
// is pushed over an edge each corner that leaves becomes the place where it left.
TEST(ConvexContacts, OfAlignedCubesStayTheSame) {
  const ConvexHull bottom(box_points({0.5, 0.5, 0.5}));
  test::Random random(5);
  const auto keys_at = [&](double x, double noise) {
    auto cube = box_points({0.5, 0.5, 0.5}, {x, 1.001, 0});
    const Vec3 aside = noise * test::random_vector(random);
    for (Vec3& v : cube) v += aside;
    const ConvexHull top(cube);
    const ConvexContacts found = contacts_of(top.shape(0), bottom.shape(0), 0.1);
    std::vector<std::uint64_t> keys;
    for (const ConvexContact& each : found) keys.push_back(each.key);
    std::sort(keys.begin(), keys.end());
    return keys;
  };
  const std::vector<std::uint64_t> aligned = keys_at(0, 0);
  EXPECT_EQ(aligned.size(), 4u);
  for (int i = 0; i < 20; ++i) EXPECT_EQ(keys_at(0, 1e-9), aligned);
  // What lies over the long edge of a thin wall is not over the wall.
  const ConvexHull wall(box_points({2, 0.5, 0.005})), box(box_points({0.1, 0.1, 0.1}, {0, 0.601, 0.1}));
  for (const ConvexContact& each : contacts_of(box.shape(0), wall.shape(0), 0.1))
    EXPECT_LE(each.on_a.z, 0.005 + 1e-5);
  for (const double x : {-0.3, -1e-3, 1e-6, 0.01, 0.3}) EXPECT_EQ(keys_at(x, 0), aligned) << x;
}

// A capsule along a face is kept off at both ends of what it has in common with it.
TEST(ConvexContacts, OfACapsuleAlongAFace) {
  const ConvexHull box(box_points({1, 1, 1}));
  const std::vector<Vec3> line{{-3, 1.3, 0.2}, {0.5, 1.3, 0.2}};
  const ConvexContacts found =
      contacts_of({.vertices = line, .normals = {}, .radius = 0.25}, box.shape(0), 0.1);
  ASSERT_EQ(found.count, 2u);
  std::vector<double> at{found.list[0].on_a.x, found.list[1].on_a.x};
  std::sort(at.begin(), at.end());
  EXPECT_NEAR(at[0], -1, 1e-12);
  EXPECT_NEAR(at[1], 0.5, 1e-12);
  EXPECT_NEAR(found.list[0].gap, 0.05, 1e-12);
}

// A ring of more corners than 16 bits can name: the nearest is the one of the highest number.
TEST(Nearness, ShapesMayHaveManyCorners) {
  std::vector<Vec3> ring;
  constexpr std::uint32_t count = 70001;
  for (std::uint32_t i = 0; i < count; ++i) {
    const double t = 2 * (i + 1.0) / count - 1;  // along a half of the unit circle, to (1, 0)
    ring.push_back({t, std::sqrt(std::max(0.0, 1 - t * t)), i % 2 == 0 ? -0.1 : 0.1});
  }
  const std::vector<Vec3> point{{3, -1, ring.back().z}};
  const Nearness near = nearness({.vertices = point, .normals = {}}, {.vertices = ring, .normals = {}});
  EXPECT_NEAR(norm(near.on_b - ring.back()), 0, 1e-12);
  EXPECT_NEAR(near.distance, std::sqrt(5.0), 1e-12);
}

// A prism of 200 sides lies on one of 199 that is a little narrower, so that every corner is cut by some
// sides. What both have in common has more corners than there is room for, and is still held all around.
TEST(ConvexContacts, OfManySidesAreAllAround) {
  const auto prism = [](std::uint32_t sides, double radius, double low, double high) {
    std::vector<Vec3> points;
    for (std::uint32_t i = 0; i < sides; ++i) {
      const double angle = 6.283185307179586 * i / sides;
      for (const double y : {low, high})
        points.push_back({radius * std::cos(angle), y, radius * std::sin(angle)});
    }
    return ConvexHull(points);
  };
  const ConvexHull upper = prism(200, 1, 0, 1), lower = prism(199, 0.9982, -1, 0);
  const ConvexContacts found = contacts_of(lower.shape(0), upper.shape(0), 0.01);
  std::vector<double> angles;
  for (const ConvexContact& each : found) {
    EXPECT_NEAR(each.gap, 0, 1e-9);
    if (norm(each.on_a) > 0.9) angles.push_back(std::atan2(each.on_a.z, each.on_a.x));
  }
  ASSERT_GT(angles.size(), 4u);
  std::sort(angles.begin(), angles.end());
  double widest = angles.front() + 6.283185307179586 - angles.back();
  for (std::size_t i = 1; i < angles.size(); ++i) widest = std::max(widest, angles[i] - angles[i - 1]);
  // Sixteen that are chosen to be far from each other leave at most a few times their mean distance.
  EXPECT_LT(widest, 3 * 6.283185307179586 / ConvexContacts::most);
}

}  // namespace
}  // namespace plumb::detail::PLUMB_TEST_FILE
