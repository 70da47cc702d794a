// What becomes of shapes where a rod breaks: one along it ends, and what falls apart collides.

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <numeric>
#include <random>
#include <span>
#include <string_view>
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

/// A rope that lies along x above the ground, and whose rods break by themselves.
Scene loose_rope(double strength) {
  Scene scene;
  scene.planes.push_back({.surface = {.friction = 0.5}});
  for (std::uint32_t i = 0; i <= rods; ++i) {
    const Vec3 at{0.1 * i, 0.4, 0};
    scene.particles.push_back(i == 0 ? test::fixed(at) : test::movable(at, 0.1));
    if (i == 0) continue;
    scene.rods.push_back({.a = i - 1, .b = i, .law = {.strength = strength}});
    scene.capsules.push_back({.a = point_at(i - 1), .b = point_at(i), .radius = 0.02});
  }
  return scene;
}

/// Asserts that all movable particles lie on the ground by a sphere each, which queries and a scene have.
void expect_spheres_on_ground(const Scene& scene, const World& world, std::string_view what) {
  const Scene now = world.scene();
  Queries queries(scene);
  queries.update(world);
  std::vector<std::uint32_t> at;
  for (const Capsule& each : now.capsules) {
    EXPECT_EQ(each.a.particles, each.b.particles) << what;
    EXPECT_EQ(each.radius, 0.02) << what;
    at.push_back(each.a.particles[0]);
  }
  std::sort(at.begin(), at.end());
  std::vector<std::uint32_t> movable;
  for (std::uint32_t i = 0; i < world.particle_count(); ++i) {
    if (scene.particles[i].fixed) continue;
    movable.push_back(i);
    EXPECT_NEAR(world.position(i).y, 0.02, 1e-3) << what << ' ' << i;
    const Hit hit = queries.cast_ray({world.position(i) + Vec3{0, 1, 0}, {0, -1, 0}, 2});
    EXPECT_EQ(hit.target.list, ShapeKind::capsule) << what;
    EXPECT_NEAR(hit.distance, 0.98, 1e-12) << "a ray from above meets its sphere";
  }
  EXPECT_EQ(at, movable) << what;
}

// Rods break or are cut, from the anchor, from the free end or as a random order has it. Whatever the order,
// all that is left is as many balls on the ground, without an anchor one more than there were capsules.
TEST(BrokenShapes, KeepParticlesOnTheGround) {
  for (const Method method : methods)
    for (const bool is_anchored : {true, false})
      for (const unsigned order : {0u, 1u, 2u, 3u, 4u}) {
        Scene scene = loose_rope(order == 0 ? 1e-3 : RodLaw{}.strength);
        scene.particles[0].fixed = is_anchored;
        scene.particles[0].mass = 0.1;
        scene.particles[rods].velocity = {0, 1, 0};  // so that a free rope tears, too
        World world(scene, settings(method));
        std::vector<std::uint32_t> cuts(order == 0 ? 0 : rods);
        std::iota(cuts.begin(), cuts.end(), 0u);
        if (order == 2) std::reverse(cuts.begin(), cuts.end());
        if (order > 2) std::shuffle(cuts.begin(), cuts.end(), std::mt19937(order));
        for (std::size_t k = 0; k < cuts.size(); ++k) {
          world.cut(cuts[k]);
          if (k % order == 0) world.step(frame);
        }
        for (int i = 0; i < 300; ++i) world.step(frame);
        for (std::uint32_t i = 0; i < rods; ++i) world.cut(i);  // of a torn one, what fell slack
        for (int i = 0; i < 120; ++i) world.step(frame);
        expect_spheres_on_ground(scene, world, to_string(method));
      }
}

// What has no hull nor capsule but that along the rod is a sphere; an anchor and what has others is none.
TEST(BrokenShapes, LeaveSpheresOnlyWhereNothingElseIs) {
  for (const Method method : methods) {
    World world(loose_rope(RodLaw{}.strength), settings(method));
    world.cut(0);  // between the anchor and a particle with another capsule
    world.step(frame);
    EXPECT_FALSE(world.has_shape({ShapeKind::capsule, 0}));
    world.cut(rods - 1);
    world.step(frame);
    EXPECT_TRUE(world.has_shape({ShapeKind::capsule, rods - 1}));
    const Scene now = world.scene();
    ASSERT_EQ(now.capsules.size(), rods - 1);
    EXPECT_EQ(now.capsules.back().a.particles[0], rods);
    EXPECT_EQ(now.capsules.back().b.particles[0], rods);
    world.join({.a = rods - 1, .b = rods});  // which has no capsule; the sphere stays
    world.step(frame);
    EXPECT_TRUE(world.has_shape({ShapeKind::capsule, rods - 1}));
    EXPECT_EQ(world.scene().capsules.size(), rods - 1);
  }
}

/// A dumbbell with a capsule along its rod, above the ground.
Scene dumbbell() {
  Scene scene;
  scene.planes.push_back({});
  scene.particles = {test::movable({0, 0.1, 0}, 1), test::movable({0.5, 0.1, 0}, 1)};
  scene.rods.push_back({.a = 0, .b = 1});
  scene.capsules.push_back({.a = point_at(0), .b = point_at(1), .radius = 0.02});
  return scene;
}

// The sphere at its second end is a capsule of the world, with a number that others can have once it is gone.
TEST(BrokenShapes, GiveTheSecondEndANumber) {
  for (const Method method : methods) {
    Settings of = settings(method);
    of.contacts = of.tensions = true;
    World world(dumbbell(), of);
    world.cut(0);
    for (int i = 0; i < 120; ++i) world.step(frame);
    const ShapeId second{ShapeKind::capsule, 1};
    ASSERT_TRUE(world.has_shape(second));
    EXPECT_NEAR(world.contact_force(second).y, 9.81, 1e-6) << to_string(method);
    std::vector<Vec3> forces(world.shape_count());
    world.copy_contact_forces(forces);
    EXPECT_EQ(forces.size(), 2u);
    EXPECT_EQ(forces[1], world.contact_force(second));
    EXPECT_EQ(world.contacts().size(), 2u);

    std::vector<std::byte> saved(world.snapshot_size());
    world.save(saved);
    World other(dumbbell(), of);
    other.restore(saved);
    world.step(frame);
    other.step(frame);
    EXPECT_EQ(other.state_hash(), world.state_hash());
    EXPECT_TRUE(other.has_shape(second));

    Settings changed = of;
    changed.method = method == Method::relax ? Method::direct : Method::relax;
    world.set_settings(changed);
    world.step(frame);
    EXPECT_TRUE(world.has_shape(second));
    EXPECT_NEAR(world.position(0).y, 0.02, 1e-3);
    EXPECT_NEAR(world.position(1).y, 0.02, 1e-3);

    world.remove(1);
    EXPECT_FALSE(world.has_shape(second));
    EXPECT_TRUE(world.has_shape({ShapeKind::capsule, 0}));
    Scene more = dumbbell();
    more.planes.clear();
    const Added next = world.add(more);
    EXPECT_EQ(next.capsule, 1u) << "the number was free";
  }
}

}  // namespace
}  // namespace plumb::PLUMB_TEST_FILE
