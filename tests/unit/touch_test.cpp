// Where shapes come nearest, against samples of their points, and the search for those that may.

#include "contact/shapes/touch.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <set>

#include "contact/near_pairs.hpp"
#include "contact/spatial_hash.hpp"
#include "contact/surroundings.hpp"
#include "support/random_trees.hpp"

namespace plumb::detail::PLUMB_TEST_FILE {
namespace {

/// Distance of the lines of two segments by samples; it exceeds the true one by less than a step of each.
double sampled_distance(const Segment& a, const Segment& b, int steps) {
  double least = 1e300;
  for (int i = 0; i <= steps; ++i)
    for (int k = 0; k <= steps; ++k)
      least =
          std::min(least, norm(between(a.p, a.q, double(i) / steps) - between(b.p, b.q, double(k) / steps)));
  return least;
}

TEST(Touch, IsNearestOfAllPoints) {
  test::Random random(21);
  for (int round = 0; round < 200; ++round) {
    const Segment a{test::random_vector(random), test::random_vector(random), 0.1},
        b{test::random_vector(random), test::random_vector(random), 0.2};
    const Touch t = touch(a, b);
    const double distance = t.gap + a.radius + b.radius, sampled = sampled_distance(a, b, 50);
    EXPECT_LE(distance, sampled + 1e-12);
    EXPECT_GE(distance, sampled - (norm(a.q - a.p) + norm(b.q - b.p)) / 100);
    EXPECT_LE(norm(between(a.p, a.q, t.a) - between(b.p, b.q, t.b) - distance * t.normal), 1e-12);
    const Touch other = touch(b, a);
    EXPECT_NEAR(other.gap, t.gap, 1e-12) << "the order does not matter";
  }
}

// Two lines that lie along each other from 1 to 2 m are kept apart at both ends of that.
TEST(Touch, OfParallelsIsAtBothEnds) {
  const Touches t = touches({{0, 0, 0}, {2, 0, 0}, 0.1}, {{1, 0.5, 0}, {3, 0.5, 0}, 0.1});
  std::set<double> places;
  for (std::uint32_t i = 0; i < t.count; ++i) {
    EXPECT_NEAR(t.at[i].gap, 0.3, 1e-15);
    places.insert(2 * t.at[i].a);
  }
  EXPECT_NEAR(*places.begin(), 1, 1e-12);
  EXPECT_NEAR(*places.rbegin(), 2, 1e-12);
  EXPECT_EQ(touches({{0, 0, 0}, {2, 0, 0}, 0.1}, {{1, -1, 1}, {1, 1, 1}, 0.1}).count, 1u) << "crossing";
}

TEST(Touch, BoxesPushBallsOutThroughTheNearestFace) {
  const Vec3 half{1, 2, 3};
  EXPECT_EQ(touch_box({3, 0, 0}, 0.5, half).gap, 1.5);
  const Touch inside = touch_box({0, -1.5, 0.5}, 0.25, half);
  EXPECT_EQ(inside.normal, (Vec3{0, -1, 0}));
  EXPECT_EQ(inside.gap, -0.75);
  const Touch corner = touch_box({4, 6, 3}, 0, half);
  EXPECT_EQ(corner.gap, 5) << "3, 4 and 0 from the corner";
}

TEST(Touch, NearestToABoxIsNearestOfSamples) {
  test::Random random(22);
  const Vec3 half{0.3, 0.2, 0.1};
  const auto distance = [&](Vec3 p) { return std::max(touch_box(p, 0, half).gap, 0.0); };
  for (int round = 0; round < 100; ++round) {
    const Vec3 p = test::random_vector(random), q = test::random_vector(random);
    const double found = distance(between(p, q, nearest_to_box(p, q, half)));
    double least = 1e300;
    for (int i = 0; i <= 200; ++i) least = std::min(least, distance(between(p, q, i / 200.0)));
    EXPECT_LE(found, least + 1e-7);
    const auto places = touching_box(p, q, half, 0.25);
    EXPECT_EQ(places[0], 0.25);
    EXPECT_NEAR(between(p, q, places[3]).x, -half.x, 1e-12);
    EXPECT_NEAR(between(p, q, places[8]).z, half.z, 1e-12);
  }
}

TEST(Frame3, TurnsThereAndBack) {
  const Frame3 frame{{0, 1, 0}, {-1, 0, 0}, {0, 0, 1}};
  EXPECT_EQ(frame.to_local({0, 2, 5}), (Vec3{2, 0, 5}));
  EXPECT_EQ(frame.to_space(frame.to_local({1, 2, 3})), (Vec3{1, 2, 3}));
}

Bounds random_bounds(test::Random& random) {
  const Vec3 center = 5.0 * test::random_vector(random);
  // One in ten is much larger than a cell.
  const double size = test::below(random, 10) == 0 ? 6 : 0.4;
  const Vec3 half = size * Vec3{1 + test::signed_unit(random), 1 + test::signed_unit(random), 1.5};
  return {center - half, center + half};
}

// All pairs that overlap are found, whichever way they are asked for, and none after it was taken out.
TEST(SpatialHash, FindsAllThatOverlap) {
  test::Random random(23);
  std::vector<Bounds> boxes;
  SpatialHash hash, both;
  hash.start(1, 100);
  both.start(1, 100);
  std::set<std::pair<std::uint32_t, std::uint32_t>> pairs;
  for (std::uint32_t i = 0; i < 200; ++i) {
    boxes.push_back(random_bounds(random));
    hash.insert(i, boxes[i]);
    both.find_and_insert(i, boxes[i], [&](std::uint32_t other) { pairs.insert({other, i}); });
  }
  int overlapping = 0, found_apart = 0;
  for (std::uint32_t i = 0; i < boxes.size(); ++i) {
    std::set<std::uint32_t> found;
    hash.find(boxes[i], [&](std::uint32_t id) { found.insert(id); });
    for (std::uint32_t k = 0; k < i; ++k) {
      if (!boxes[i].overlaps(boxes[k])) {
        found_apart += found.contains(k);
        continue;
      }
      ++overlapping;
      EXPECT_TRUE(found.contains(k)) << i << ", " << k;
      EXPECT_TRUE(pairs.contains({k, i})) << i << ", " << k;
    }
  }
  EXPECT_GT(overlapping, 500);
  EXPECT_LT(found_apart, 200 * 199 / 4) << "it looks at half of all pairs";
  for (std::uint32_t i = 0; i < boxes.size(); ++i) hash.remove(i, boxes[i]);
  EXPECT_TRUE(hash.is_empty());
  hash.find({{-9, -9, -9}, {9, 9, 9}}, [&](std::uint32_t id) { ADD_FAILURE() << id << " is still there"; });
}

// A box as far away as a double reaches is found by one that is there too.
TEST(SpatialHash, KnowsNoFarthestPlace) {
  SpatialHash hash;
  hash.start(1, 1);
  const Bounds far{{1e300, 0, 0}, {2e300, 1, 1}};
  hash.insert(7, far);
  int found = 0;
  hash.find(far, [&](std::uint32_t id) { found += id == 7; });
  EXPECT_EQ(found, 1);
}

// Few boxes are compared with each other, many are put into cells. One that is not finite overlaps others,
// too.
TEST(NearPairs, AreAllThatOverlapInOrder) {
  test::Random random(25);
  NearPairs pairs;
  for (const std::uint32_t count : {0u, 1u, 5u, 200u, 30u}) {
    std::vector<Bounds> boxes;
    for (std::uint32_t i = 0; i < count; ++i) boxes.push_back(random_bounds(random));
    if (count > 5) boxes[3].high.x = INFINITY;
    std::vector<NearPairs::Pair> wanted;
    for (std::uint32_t k = 0; k < count; ++k)
      for (std::uint32_t l = k + 1; l < count; ++l)
        if (boxes[k].overlaps(boxes[l])) wanted.push_back({k, l});
    const std::span<const NearPairs::Pair> found = pairs.find(boxes);
    EXPECT_TRUE(std::equal(found.begin(), found.end(), wanted.begin(), wanted.end())) << count;
    EXPECT_EQ(pairs.found().size(), wanted.size());
  }
}

// The lowest corner of a box is its height above a plane.
TEST(Surroundings, HeightIsOfTheLowestCorner) {
  test::Random random(24);
  for (int round = 0; round < 50; ++round) {
    Vec3 normal = test::random_vector(random);
    normal = (1 / norm(normal)) * normal;
    const Plane plane{.normal = normal, .offset = test::signed_unit(random)};
    const Bounds b = random_bounds(random);
    double least = 1e300;
    for (const double x : {b.low.x, b.high.x})
      for (const double y : {b.low.y, b.high.y})
        for (const double z : {b.low.z, b.high.z})
          least = std::min(least, dot(normal, {x, y, z}) - plane.offset);
    EXPECT_NEAR(height(b, plane), least, 1e-13);
  }
}

// A box of the scene turned by 45° about z reaches √2 times as far along x and y.
TEST(Surroundings, BoxesReachAsFarAsTheirCorners) {
  Scene scene;
  EXPECT_TRUE(Surroundings(scene).are_empty());
  const double turn = std::acos(-1.0) / 8;
  scene.boxes = {
      {.center = {0, 0, 0}, .half_size = {1, 1, 1}, .orientation = {std::cos(turn), 0, 0, std::sin(turn)}}};
  const Surroundings around(scene);
  EXPECT_NEAR(around.shapes[0].bounds().high.x, std::sqrt(2.0), 1e-12);
  EXPECT_NEAR(around.shapes[0].bounds().high.z, 1, 1e-12);
  const std::array any{Filter{}};
  EXPECT_TRUE(around.reach_into({{1.4, 0, 0}, {2, 1, 1}}, any));
  EXPECT_FALSE(around.reach_into({{1.42, 0, 0}, {2, 1, 1}}, any));
}

}  // namespace
}  // namespace plumb::detail::PLUMB_TEST_FILE
