// When something that moves straight on is touched first, against small steps, and that none comes through.

#include "contact/shapes/sweep.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <optional>

#include "contact/shapes/hulls/convex_hull.hpp"
#include "contact/shapes/passing.hpp"
#include "support/meshes.hpp"

namespace plumb::detail::PLUMB_TEST_FILE {
namespace {

using test::random_vector;

constexpr double close = 1e-6;

Vec3 at(Vec3 p, Vec3 by, double t) {
  return p + t * by;
}

MovingSegment random_segment(test::Random& random, double length) {
  const Vec3 p = 1.2 * random_vector(random);
  const bool is_point = test::below(random, 3) == 0;
  const Vec3 q = is_point ? p : p + length * random_vector(random), by = 2.0 * random_vector(random);
  return {{p, q, 0.01 + 0.1 * std::abs(test::signed_unit(random))},
          by,
          is_point ? by : by + 0.3 * random_vector(random)};
}

/// Counts what was swept: what touched on its way, and what did at the start.
struct Swept {
  int touched = 0, at_start = 0;

  /// Things are apart by `gap`(time) until they touch, if they do, and come nearer by `nears`(found) < 0.
  template <class Found, class Gap, class Nears>
  void expect_first(const std::optional<Found>& found, Gap&& gap, Nears&& nears) {
    const double until = found ? found->time : 1;
    if (found && until == 0) {
      ++at_start;
      EXPECT_LE(gap(0), close);
      return;
    }
    for (int i = 0; i <= 100; ++i) EXPECT_GE(gap(until * i / 100), 0);
    if (!found) return;
    ++touched;
    EXPECT_LE(gap(until), close);
    EXPECT_LT(nears(*found), 0);
  }
  void expect_many() const {
    EXPECT_GT(touched, 100);
    EXPECT_GT(at_start, 20);
  }
};

TEST(Sweep, FirstTouchIsThatOfSmallSteps) {
  test::Random random(51);
  Swept swept;
  for (int round = 0; round < 3000; ++round) {
    const Triangle t{random_vector(random), random_vector(random), random_vector(random)};
    const MovingSegment moving = random_segment(random, 0.5);
    const auto gap = [&](double time) {
      return nearest_on(t, at(moving.at.p, moving.p_by, time), at(moving.at.q, moving.q_by, time)).distance -
             moving.at.radius;
    };
    swept.expect_first(sweep(moving, t, close), gap, [&](const auto& found) {
      return std::min(dot(found.normal, moving.p_by), dot(found.normal, moving.q_by));
    });
  }
  swept.expect_many();
}

// Two lines that both move: they are apart until they touch, and touch along the normal.
TEST(Sweep, FirstTouchOfTwoLinesIsThatOfSmallSteps) {
  test::Random random(53);
  Swept swept;
  for (int round = 0; round < 10000; ++round) {
    const MovingSegment a = random_segment(random, 0.5), b = random_segment(random, 0.5);
    const auto line = [](const MovingSegment& each, double time) {
      return Segment{at(each.at.p, each.p_by, time), at(each.at.q, each.q_by, time), each.at.radius};
    };
    const auto gap = [&](double time) { return touch(line(a, time), line(b, time)).gap; };
    swept.expect_first(sweep(a, b, close), gap, [&](const auto& found) {
      return dot(found.normal, moved_between(a, b, found.a, found.b));
    });
  }
  swept.expect_many();
}

// What goes deeper than is harmless on its way is found, and only that. Steps of a thousandth see depths to
// the way in half of one.
TEST(Sweep, LinesThatPassThroughEachOtherAreFound) {
  const PairSearch search{.margin = 2e-3, .close = close};
  test::Random random(54);
  int passed = 0, spared = 0;
  for (int round = 0; round < 10000; ++round) {
    const MovingSegment a = random_segment(random, 0.5), b = random_segment(random, 0.5);
    const double radii = a.at.radius + b.at.radius;
    const auto apart = [&](double time) {
      return touch({at(a.at.p, a.p_by, time), at(a.at.q, a.q_by, time), 0},
                   {at(b.at.p, b.p_by, time), at(b.at.q, b.q_by, time), 0})
          .gap;
    };
    if (apart(0) < radii) continue;
    double least = apart(0);
    for (int i = 1; i <= 1000; ++i) least = std::min(least, apart(i / 1000.0));
    const double core = radii - search.harmless(std::min(a.at.radius, b.at.radius));
    const double unseen = 0.5e-3 * moves_between(a, b);
    const auto plane = search.passed(a, b);
    if (least < core - unseen) {
      ++passed;
      EXPECT_TRUE(plane);
    } else if (least > core + close) {
      ++spared;
      EXPECT_FALSE(plane);
    }
    EXPECT_TRUE(!plane || plane->gap >= 0);
  }
  EXPECT_GT(passed, 100);
  EXPECT_GT(spared, 100);
}

/// A landscape that is high and folded, so that shots meet it from all sides.
test::Mesh crags(std::uint32_t cells, test::Random& random) {
  test::Mesh out = test::landscape(cells, 0.2, [](double, double) { return 0.0; });
  for (Vec3& v : out.vertices) v += 0.15 * random_vector(random);
  return out;
}

// 100,000 shots: where nothing is touched, the way of the line crosses no triangle. Where something is, the
// line has not crossed it yet.
TEST(Sweep, NoShotComesThrough) {
  test::Random random(52);
  const test::Mesh land = crags(12, random);
  const TriangleMesh mesh(land.vertices, land.triangles, MeshSides::both);
  int touched = 0, through = 0;
  for (int shot = 0; shot < 100000; ++shot) {
    Vec3 p = 2.0 * random_vector(random), by = 4.0 * random_vector(random);
    p.y = std::copysign(0.5 + 0.5 * std::abs(p.y), -by.y);
    const double radius = 0.001 + 0.05 * std::abs(test::signed_unit(random));
    const auto found = sweep({{p, p, radius}, by, by}, mesh, close);
    touched += found.has_value();
    const Vec3 end = at(p, by, found ? found->time : 1);
    bool crossed = false;
    Bounds box = nowhere;
    include(box, p, 0);
    include(box, end, 0);
    mesh.find(box, [&](std::uint32_t i) { crossed = crossed || crosses(mesh.triangle(i), p, end); });
    through += crossed;
    if (found) {
      EXPECT_LT(dot(found->normal, by), 0);
    }
  }
  EXPECT_EQ(through, 0);
  EXPECT_GT(touched, 20000);
}

// A hull is touched where small steps find it, and not passed through.
TEST(Sweep, HullsAreTouchedFirstToo) {
  test::Random random(54);
  int touched = 0;
  for (int round = 0; round < 1000; ++round) {
    std::vector<Vec3> points;
    for (int i = 0; i < 12; ++i) points.push_back(0.7 * random_vector(random));
    const ConvexHull hull(points);
    const Convex shape = hull.shape(0.05);
    MovingSegment moving = random_segment(random, 0.5);
    moving.at.p += Vec3{2, 0, 0}, moving.at.q += Vec3{2, 0, 0};
    moving.p_by += Vec3{-3, 0, 0}, moving.q_by += Vec3{-3, 0, 0};
    const auto gap = [&](double time) {
      const std::array<Vec3, 2> line{at(moving.at.p, moving.p_by, time), at(moving.at.q, moving.q_by, time)};
      return nearness({.vertices = line, .normals = {}}, shape).distance - moving.at.radius - 0.05;
    };
    const auto found = sweep(moving, shape, close);
    if (gap(0) <= 0) continue;
    const double until = found ? found->time : 1;
    for (int i = 0; i <= 100; ++i) EXPECT_GT(gap(until * i / 100), 0);
    if (found) ++touched;
    EXPECT_LE(gap(until), found ? close : INFINITY);
  }
  EXPECT_GT(touched, 150);
}

// What slides over a floor of triangles meets no edge of it; a wall behind it does stop.
TEST(Sweep, FloorHasNoEdges) {
  test::Random random(53);
  test::Mesh floor = test::shuffled_floor(40, 0.1, random);
  const auto first = static_cast<std::uint32_t>(floor.vertices.size());
  for (const Vec3 corner : {Vec3{1.5, -1, -3}, Vec3{1.5, -1, 3}, Vec3{1.5, 3, 0}})
    floor.vertices.push_back(corner);
  floor.triangles.push_back({first, first + 1, first + 2});
  const TriangleMesh mesh(floor.vertices, floor.triangles, MeshSides::both);
  for (int round = 0; round < 500; ++round) {
    const double z = test::signed_unit(random);
    const MovingSegment ball{{{-1.4, 0.1, z}, {-1.4, 0.1, z}, 0.1}, {2.5, 0, 0}, {2.5, 0, 0}};
    EXPECT_FALSE(sweep(ball, mesh, close));
    const Vec3 far{3.5, -1e-7, 0.2};
    const auto wall = sweep({ball.at, far, far}, mesh, close);
    ASSERT_TRUE(wall);
    EXPECT_NEAR(wall->time * far.x, 2.8, 1e-5);
    EXPECT_NEAR(wall->normal.x, -1, 1e-12);
  }
}

}  // namespace
}  // namespace plumb::detail::PLUMB_TEST_FILE
