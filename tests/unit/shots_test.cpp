// Shots as they are made and judged: what is in their scenes, and that what passes through is seen.

#include "stability/shots/shots.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <set>

#include "plumb/joints.hpp"
#include "scenes/humanoid/limbs.hpp"
#include "scenes/spec.hpp"
#include "support/worlds.hpp"

namespace plumb::scenes::PLUMB_TEST_FILE {
namespace {

const ShotWay& way(const std::string& name) {
  const auto& all = shot_ways();
  return *std::find_if(all.begin(), all.end(), [&](const ShotWay& w) { return w.name == name; });
}

/// Returns the first shot of its kind, with a missile that touches nothing.
Shot ghost(Target target, Missile missile, std::uint64_t from = 0) {
  for (std::uint64_t number = from;; ++number) {
    Shot shot = make_shot({number});
    if (shot.target != target || shot.missile != missile) continue;
    const double length = norm(shot.approach) * shot.dt * shot.steps;
    if (length < 3 * (shot.radius + 1) || length > 12) continue;
    for (Capsule& each : shot.scene.capsules)
      if (each.a.particles[0] >= shot.first) each.filter.mask = 0;
    return shot;
  }
}

TEST(Shots, AreTheSameAgain) {
  for (const std::uint64_t number : {0u, 7u, 10u, 123u}) {
    const Shot one = make_shot({number, 3}), same = make_shot({number, 3}), other = make_shot({number, 4});
    EXPECT_EQ(start_of(one.scene), start_of(same.scene));
    EXPECT_EQ(one.dt, same.dt);
    EXPECT_EQ(one.target, other.target);
    EXPECT_NE(one.dt, other.dt);
  }
  EXPECT_EQ(start_of(load_scene("shot:number=7,seed=3")), start_of(make_shot({7, 3}).scene));
}

// Radii, speeds and steps are what the header says. Missiles start outside, by 1 mm at least: to within what
// a place that moves with a body is rounded by.
TEST(Shots, StartOutsideOfWhatTheyFlyAt) {
  std::set<std::pair<Target, Missile>> kinds;
  for (std::uint64_t number = 0; number < 480; ++number) {
    const Shot shot = make_shot({number});
    SCOPED_TRACE("shot " + std::to_string(number) + ": " + shot.text());
    kinds.emplace(shot.target, shot.missile);
    EXPECT_GE(shot.radius, 0.005);
    EXPECT_LE(shot.radius, 1);
    EXPECT_LE(norm(shot.approach), 100);
    EXPECT_GE(shot.dt, 1.0 / 240);
    EXPECT_LE(shot.dt, 1.0 / 15);
    EXPECT_LT(dot(shot.approach, shot.out), 0);
    EXPECT_NO_THROW(validate(shot.scene));
    const std::vector<Vec3> start = start_of(shot.scene);
    if (!is_wall(shot.target)) {
      EXPECT_GE(clearance(shot.targets, shot.missiles, start, {}), 1e-3 - 1e-9);
    } else {
      for (const Point& each : shot.outermost)
        EXPECT_GT(shot.out.y * place_of(each, start).y, wall_thickness);
    }
  }
  EXPECT_EQ(kinds.size(), all_targets().size() * 4);
}

TEST(Shots, LinesAreAsFarApartAsTheyAre) {
  EXPECT_EQ(distance_of_lines({0, 0, 0}, {0, 0, 0}, {3, 4, 0}, {3, 4, 0}), 5);
  EXPECT_EQ(distance_of_lines({-1, 0, 0}, {1, 0, 0}, {0, 2, -1}, {0, 2, 1}), 2);
  EXPECT_EQ(distance_of_lines({-1, 0, 0}, {1, 0, 0}, {4, 4, 0}, {4, 4, 9}), 5);
  EXPECT_EQ(distance_of_lines({-1, 0, 0}, {1, 0, 0}, {0, 3, 0}, {9, 3, 0}), 3);
  EXPECT_EQ(distance_of_lines({0, 0, 0}, {0, 0, 0}, {-1, 3, 0}, {1, 3, 0}), 3);
  EXPECT_EQ(distance_of_lines({-1, 3, 0}, {1, 3, 0}, {0, 0, 0}, {0, 0, 0}), 3);
}

TEST(Shots, CoresSayHowDeepTheyAre) {
  const std::vector<Vec3> positions = {{0, 0, 0}, {2, 0, 0}, {1, 3, 0}};
  const std::vector<Core> rod = {{point_at(0), point_at(1), 0.5, 0.5}},
                          ball = {{point_at(2), point_at(2), 1, 2}};
  EXPECT_EQ(clearance(rod, ball, positions, {}), 0.5);
  EXPECT_EQ(clearance(rod, ball, positions, {0, -1, 0}), -0.5);
  EXPECT_EQ(share_inside(rod, ball, positions), -3);
  EXPECT_TRUE(flies_into(rod, ball, positions, {0, -9, 0}));
  EXPECT_TRUE(flies_into(rod, ball, positions, {1, -2, 0}));
  EXPECT_FALSE(flies_into(rod, ball, positions, {1, -1.7, 0})) << "a fifth of its radius inside";
  EXPECT_FALSE(flies_into(rod, ball, positions, {0, 9, 0}));
  EXPECT_FALSE(flies_into(rod, ball, positions, {0, 0, 9}));
}

TEST(Shots, NetsHaveTwoSides) {
  // One mesh with a fold: its corner of largest x and z is 1 m up.
  const std::vector<Vec3> net = {{0, 0, 0}, {1, 0, 0}, {0, 0, 1}, {1, 1, 1}};
  EXPECT_TRUE(is_behind_net(net, 2, {0.2, -0.5, 0.3}, {0, 1, 0}));
  EXPECT_FALSE(is_behind_net(net, 2, {0.2, 0.5, 0.3}, {0, 1, 0}));
  EXPECT_TRUE(is_behind_net(net, 2, {0.2, 0.5, 0.3}, {0, -1, 0}));
  EXPECT_TRUE(is_behind_net(net, 2, {0.9, 0.5, 0.8}, {0, 1, 0}));
  EXPECT_FALSE(is_behind_net(net, 2, {1.2, -0.5, 0.3}, {0, 1, 0})) << "beside it";
}

// A missile that touches nothing passes through everything, and that is seen.
TEST(Shots, WhatPassesThroughIsSeen) {
  for (const Target target : {Target::sheet, Target::box, Target::rope, Target::net, Target::flying_rope,
                              Target::flying_net, Target::figure}) {
    int seen = 0;
    std::uint64_t from = 0;
    for (int i = 0; i < 5; ++i, from += 96) {
      Shot shot = ghost(target, Missile::ball, from);
      if (is_wall(target)) {
        shot.scene.meshes.clear();
        shot.scene.boxes.clear();
      }
      const ShotResult result = fly(shot, way("direct"));
      EXPECT_FALSE(result.hit) << shot.text();
      seen += result.through;
    }
    EXPECT_GE(seen, 3) << to_string(target) << ": a few pass by";
  }
}

// A motor pulls the ball towards the wall with 1 kN, and so brings energy, which no scene here may gain.
TEST(Shots, RisingEnergyIsSeen) {
  Shot shot = make_shot({0});
  ASSERT_EQ(shot.missile, Missile::ball);
  EXPECT_EQ(fault_of(fly(shot, way("direct"))), "");
  const Vec3 ahead = (100 / norm(shot.approach)) * shot.approach;
  const Vec3 ball = shot.scene.particles[shot.first].position;
  shot.scene.particles.push_back({.position = ball + ahead, .fixed = true});
  shot.scene.springs.push_back({.a = point_at(shot.first), .b = point_at(shot.first + 1), .force = 1000});
  EXPECT_TRUE(fly(shot, way("direct")).gained);
}

}  // namespace
}  // namespace plumb::scenes::PLUMB_TEST_FILE
