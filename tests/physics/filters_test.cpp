// Filters say what may touch what, in every phase of contact.

#include <gtest/gtest.h>

#include "contact/clusters.hpp"
#include "contact/linkage/linkage_bounds.hpp"
#include "support/bodies.hpp"
#include "support/linkages.hpp"

namespace plumb {
namespace {

using test::frame;

/// A ball of 0.1 m at a height, with a filter.
std::uint32_t add_ball(Scene& scene, double x, double height, Filter filter) {
  const std::uint32_t ball = test::add_ball(scene, {x, height, 0}, 0.1, 1);
  scene.capsules.back().filter = filter;
  return ball;
}

// Balls over a plane, a box on it, and a resting ball: each lies on the highest thing that it may touch.
TEST(Filters, LetThingsFallThroughWhatTheyDoNotTouch) {
  constexpr std::uint32_t floor = 1, furniture = 2, balls = 4;
  Scene scene;
  scene.planes.push_back({.filter = {.category = floor}});
  scene.boxes.push_back({.center = {0, 0.5, 0}, .half_size = {9, 0.5, 9}, .filter = {.category = furniture}});
  const std::uint32_t usual = add_ball(scene, 0, 1.5, {.category = balls, .mask = floor | furniture | balls});
  const std::uint32_t on_top =
      add_ball(scene, 0, 2.5, {.category = balls, .mask = floor | furniture | balls});
  const std::uint32_t through_box = add_ball(scene, 2, 1.5, {.category = balls, .mask = floor});
  const std::uint32_t through_all = add_ball(scene, 4, 1.5, {.category = balls, .mask = balls});
  const std::uint32_t through_balls = add_ball(scene, 0, 3.5, {.category = 8, .mask = furniture});
  World world(scene, test::body_settings(2));
  test::run(world, frame, 120);
  EXPECT_NEAR(world.position(usual).y, 1.1, 1e-3);
  EXPECT_NEAR(world.position(on_top).y, 1.3, 2e-3);
  EXPECT_NEAR(world.position(through_box).y, 0.1, 1e-3);
  EXPECT_NEAR(world.position(through_all).y, 1.5 - test::earth * 2, 1e-9);
  EXPECT_NEAR(world.position(through_balls).y, 1.1, 1e-3);
}

// Where two shapes end at one particle, the larger end counts, but only of those that touch the same.
TEST(Filters, OfShapesThatShareAParticleAreKeptApart) {
  Scene scene;
  scene.planes.push_back({.filter = {.category = 2}});
  const std::uint32_t ball = add_ball(scene, 0, 1, {});
  scene.capsules.push_back(scene.capsules[0]);
  scene.capsules[1].radius = 0.3;
  scene.capsules[1].filter.mask = 1;
  World world(scene, test::body_settings(2));
  test::run(world, frame, 120);
  EXPECT_NEAR(world.position(ball).y, 0.1, 1e-3);
}

std::uint32_t clusters_of(const Scene& scene) {
  test::Linkages islands(scene);
  detail::Clusters clusters;
  clusters.start(islands.states, 0);
  detail::Team team(1);
  clusters.form(team, [&](const detail::LinkageState& state) {
    return detail::bounds_of(*state.linkage, state.x, 0.5);
  });
  return clusters.count();
}

// The broad phase does not put islands together that cannot touch.
TEST(Filters, KeepIslandsOutOfClusters) {
  Scene scene;
  for (int i = 0; i < 4; ++i) add_ball(scene, 0.3 * i, 0, {.group = -1});
  EXPECT_EQ(clusters_of(scene), 4u);
  scene.capsules[2].filter = {};
  EXPECT_EQ(clusters_of(scene), 1u) << "all may touch the third";
  scene.capsules[2].filter = {.category = 2};
  scene.capsules[0].filter.mask = 1;
  EXPECT_EQ(clusters_of(scene), 2u) << "but the first";
}

// A sleeper is not woken by what falls through it.
TEST(Filters, LetSleepersSleep) {
  Scene scene;
  scene.planes.push_back({});
  const std::uint32_t sleeper = add_ball(scene, 0, 0.1, {.group = -1});
  scene.particles[sleeper].asleep = true;
  add_ball(scene, 0, 1, {.group = -1});
  World world(scene, test::body_settings(1, true));
  std::uint32_t most = 0;
  for (int i = 0; i < 60; ++i) most = std::max(most, world.step(frame).awake_islands);
  EXPECT_EQ(most, 1u);
}

}  // namespace
}  // namespace plumb
