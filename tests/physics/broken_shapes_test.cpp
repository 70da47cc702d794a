// What becomes of shapes where a rod breaks: one along it ends, and what falls apart collides.

#include <gtest/gtest.h>

#include <cmath>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "plumb/plumb.hpp"
#include "support/bodies.hpp"
#include "support/breaking.hpp"
#include "support/worlds.hpp"

namespace plumb::PLUMB_TEST_FILE {
namespace {

constexpr double frame = 1.0 / 120;
constexpr std::uint32_t rods = 8, weak = 4;

constexpr Method methods[] = {Method::direct, Method::relax, Method::automatic};

Settings settings(Method method) {
  Settings out{.method = method, .threads = 1};
  if (method == Method::relax) out.substeps = 8;
  return out;
}

/// A rope between two anchors, with capsules along it. Its middle rod bears no weight, and breaks at once.
Scene breaking_rope(const RodLaw& law) {
  Scene scene;
  for (std::uint32_t i = 0; i <= rods; ++i) {
    const Vec3 at{0.1 * i, 2, 0};
    scene.particles.push_back(i % rods == 0 ? test::fixed(at) : test::movable(at, 0.1));
    if (i == 0) continue;
    scene.rods.push_back({.a = i - 1, .b = i, .length = 0.102, .law = law});
    scene.capsules.push_back({.a = point_at(i - 1), .b = point_at(i), .radius = 0.02});
  }
  scene.rods[weak].law.strength = 0.1;
  return scene;
}

// The ends of both parts hang at the same height, and a capsule between them would catch the ball.
TEST(BrokenShapes, EndWithTheirRod) {
  for (const Method method : methods)
    for (const RodLaw& law : test::breaking_laws) {
      if (method == Method::relax && std::isfinite(law.stiffness)) continue;  // 1e5 N/m need more sweeps
      Scene scene = breaking_rope(law);
      test::add_ball(scene, {0.05 * rods, 4, 0}, 0.05, 1);
      World world(scene, settings(method));
      StepReport total;
      for (int i = 0; i < 120; ++i) total += world.step(frame);
      EXPECT_EQ(total.broken_rods, 1u);
      for (std::uint32_t k = 0; k < rods; ++k)
        EXPECT_EQ(world.has_shape({ShapeKind::capsule, k}), k != weak) << k;
      // It falls by g t^2 / 2 in both orders of integration to g t dt.
      EXPECT_NEAR(world.position(rods + 1).y, 4 - 4.905, 9.81 * frame) << to_string(method);
      EXPECT_NEAR(world.velocity(rods + 1).y, -9.81, 1e-9) << to_string(method);
    }
}

// A ball breaks off and falls on the ground. The one that it hung from follows, and comes to rest beside it.
TEST(BrokenShapes, CollideWithWhatTheyHungFrom) {
  constexpr double radius = 0.1;
  for (const Method method : methods) {
    Scene scene;
    scene.planes.push_back({});
    scene.particles = {test::fixed({0, 1.5, 0}), test::movable({0, 1, 0}, 1), test::movable({0, 0.7, 0}, 1)};
    for (std::uint32_t i = 0; i < 2; ++i) {
      scene.rods.push_back({.a = i, .b = i + 1});
      scene.capsules.push_back(sphere_at(point_at(i + 1), radius));
    }
    scene.rods[1].law.strength = 1;
    World world(scene, settings(method));
    EXPECT_EQ(world.step(frame).broken_rods, 1u) << to_string(method);
    for (int i = 0; i < 120; ++i) world.step(frame);
    EXPECT_NEAR(world.position(2).y, radius, 1e-3) << "it lies on the ground";
    world.cut(0);
    for (int i = 0; i < 240; ++i) {
      world.step(frame);
      ASSERT_GE(norm(world.position(1) - world.position(2)), 2 * radius - 1e-3) << to_string(method) << i;
    }
    EXPECT_LE(world.position(1).y, 3 * radius + 1e-3);
  }
}

// A snapshot is taken after a rod broke, and before its island is made anew.
TEST(BrokenShapes, GoOnFromASnapshot) {
  for (const Method method : methods) {
    const Scene scene = breaking_rope({});
    World world(scene, settings(method));
    while (world.step(frame).broken_rods == 0) {
    }
    std::vector<std::byte> saved(world.snapshot_size());
    world.save(saved);
    World other(scene, settings(method));
    other.restore(saved);
    for (int i = 0; i < 60; ++i) {
      world.step(frame);
      other.step(frame);
    }
    EXPECT_EQ(world.state_hash(), other.state_hash()) << to_string(method);
    EXPECT_FALSE(other.has_shape({ShapeKind::capsule, weak}));
  }
}

}  // namespace
}  // namespace plumb::PLUMB_TEST_FILE
