// Rods that join islands with shapes to others, and anchors that are freed from which such islands hang.

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

#include "plumb/plumb.hpp"
#include "support/edited_worlds.hpp"
#include "support/figures.hpp"
#include "support/worlds.hpp"

namespace plumb::PLUMB_TEST_FILE {
namespace {

using test::expect_refusal;

constexpr double frame = 1.0 / 60;

/// Appends a rope of four rods of 0.1 m, with capsules along them or none.
void add_rope(Scene& scene, Vec3 from, Vec3 way, bool is_anchored, bool has_shapes = true) {
  test::add_rope(scene, from, way, is_anchored, has_shapes ? 0.02 : 0);
}

/// A rope on a floor, one that hangs above it, one that hangs far away, and one without shapes.
Scene several() {
  Scene scene;
  scene.planes.push_back({.normal = {0, 1, 0}, .offset = 0});
  add_rope(scene, {0, 0.02, 0}, {1, 0, 0}, false);
  add_rope(scene, {0.2, 0.5, 0.01}, {0, -1, 0}, true);
  add_rope(scene, {9, 2, 0}, {1, 0, 0}, true);
  add_rope(scene, {0, 3, 0}, {1, 0, 0}, true, false);
  return scene;
}

template <class F>
void for_all(F&& f) {
  for (const Method method : {Method::automatic, Method::direct, Method::relax})
    for (const Precision precision : {Precision::double_, Precision::single}) {
      SCOPED_TRACE(std::string(to_string(method)) + " " + std::string(to_string(precision)));
      Settings settings{.method = method, .precision = precision, .substeps = 4, .tensions = true};
      settings.contacts = settings.events = true;
      if (method == Method::relax) settings.stop.sweeps = 50;
      f(settings);
    }
}

/// Returns `scene` as a world of it is now.
Scene scene_now(Scene scene, const World& world) {
  for (std::uint32_t i = 0; i < scene.particles.size(); ++i) {
    scene.particles[i].position = world.position(i);
    scene.particles[i].velocity = world.velocity(i);
  }
  return scene;
}

/// A fresh world does not know the forces of contact in the last substep, from which a step looks for its
/// own: to 1e-7 m where they are solved, and relaxed to what so few sweeps leave. Measured 9e-8 and 3e-5.
double tolerance(const Settings& settings) {
  return settings.method == Method::relax ? 1e-4 : 1e-6;
}

/// Lets a world and a fresh one of its scene do a step, which moves both alike. Returns the fresh one.
World step_beside(World& world, const Scene& scene, const Settings& settings) {
  World fresh(scene, settings);
  world.step(frame);
  fresh.step(frame);
  EXPECT_LE(test::apart(world, fresh), tolerance(settings));
  return fresh;
}

// The rope falls onto the floor, and onto the one that lies there.
TEST(MeetingEdits, FreeWhatHangsOverAFloor) {
  for_all([](const Settings& settings) {
    World world(several(), settings);
    test::run(world, frame, 10);
    world.free(5);
    Scene scene = scene_now(several(), world);
    scene.particles[5].fixed = false;
    step_beside(world, scene, settings);
    EXPECT_EQ(world.info().islands, 4u);
    test::run(world, frame, 120);
    for (std::uint32_t i = 0; i < 10; ++i) {
      EXPECT_GT(world.position(i).y, 0.015) << i;
      EXPECT_LT(world.position(i).y, 0.15) << i;
    }
    EXPECT_TRUE(world.problems().empty());
  });
}

// One rope of the two hangs from the other's anchor then, and lifts it from the floor.
TEST(MeetingEdits, JoinWhatLiesToWhatHangs) {
  for_all([](const Settings& settings) {
    Scene scene = several();
    World world(scene, settings);
    test::run(world, frame, 10);
    const double length = norm(world.position(9) - world.position(2));
    const Rod rod{.a = 9, .b = 2, .length = length};
    world.join(rod);
    scene = scene_now(scene, world);
    scene.rods.push_back(rod);
    step_beside(world, scene, settings);
    EXPECT_EQ(world.info().islands, 3u);
    test::run(world, frame, 30);
    EXPECT_NEAR(norm(world.position(9) - world.position(2)), length, 1e-3 * length);
    world.cut(16);
    test::run(world, frame, 30);
    EXPECT_EQ(world.info().islands, 4u);
    EXPECT_TRUE(world.problems().empty());
  });
}

// What had no shapes goes on without, in an island that has some.
TEST(MeetingEdits, JoinShapesToARopeWithout) {
  for_all([](const Settings& settings) {
    Scene scene = several();
    World world(scene, settings);
    test::run(world, frame, 10);
    const Rod rod{.a = 19, .b = 5, .length = norm(world.position(19) - world.position(5))};
    world.free(5);
    world.join(rod);
    scene = scene_now(scene, world);
    scene.particles[5].fixed = false;
    scene.rods.push_back(rod);
    World fresh = step_beside(world, scene, settings);
    EXPECT_EQ(world.info().islands, 3u);
    test::run(world, frame, 3);
    test::run(fresh, frame, 3);
    EXPECT_FALSE(world.contacts().empty());
    EXPECT_GT(std::abs(fresh.tension(16)), 0.1);
    EXPECT_NEAR(world.tension(16), fresh.tension(16), 0.05 * std::abs(fresh.tension(16)));
    test::run(world, frame, 60);
    EXPECT_TRUE(world.problems().empty());
  });
}

// All in one step, beside a cut: two ropes that hang from the freed particle become one.
TEST(MeetingEdits, GoTogetherWithOthers) {
  for_all([](const Settings& settings) {
    Scene scene = several();
    add_rope(scene, {9, 2, 0}, {0, 0, 1}, true);
    scene.rods[16].a = 10;  // from the anchor of the third rope
    scene.capsules[12].a = point_at(10);
    scene.particles[20].fixed = false;
    World world(scene, settings);
    test::run(world, frame, 10);
    const std::uint32_t islands = world.info().islands;
    world.free(10);
    world.cut(1);
    world.set_mass(8, 0.3);
    world.fix(7);
    test::run(world, frame, 30);
    EXPECT_EQ(world.info().islands, islands + 1);
    EXPECT_LT(world.position(10).y, 1.9);
    EXPECT_TRUE(world.problems().empty());
  });
}

// Orders that are taken back change nothing, and what lies goes on lying.
TEST(MeetingEdits, TakeBackWhatWasFixed) {
  for_all([](const Settings& settings) {
    World world(several(), settings), other(several(), settings);
    test::run(world, frame, 10);
    test::run(other, frame, 10);
    for (const std::uint32_t particle : {2u, 7u}) {
      world.fix(particle);
      world.free(particle);
    }
    world.free(5);
    world.fix(5);
    test::run(world, frame, 30);
    test::run(other, frame, 30);
    EXPECT_EQ(world.state_hash(), other.state_hash());
    EXPECT_FALSE(world.contacts().empty());
    EXPECT_EQ(world.info().islands, other.info().islands);
  });
}

// A capsule stays as long as one of its ends can move.
TEST(MeetingEdits, KeepTheCapsuleOfARodThatTurnsRound) {
  for_all([](const Settings& settings) {
    World world(several(), settings);
    world.free(5);
    world.fix(6);
    world.step(frame);
    EXPECT_TRUE(world.has_shape({ShapeKind::capsule, 4}));
    test::run(world, frame, 60);
    EXPECT_GT(world.position(5).y, 0.25);
    EXPECT_TRUE(world.problems().empty());
  });
}

// A capsule may reach an anchor to which no rod leads any more.
TEST(MeetingEdits, KnowAnchorsOfCapsulesAlone) {
  for_all([](const Settings& settings) {
    Scene scene = several();
    scene.capsules[4] = {.a = point_at(5), .b = point_at(7), .radius = 0.02};
    World world(scene, settings);
    world.cut(4);
    test::run(world, frame, 3);
    world.join({.a = 6, .b = 19, .length = norm(world.position(6) - world.position(19))});
    test::run(world, frame, 3);
    EXPECT_EQ(world.info().islands, 3u);
    EXPECT_TRUE(world.problems().empty());
  });
}

TEST(MeetingEdits, AreKnownToSnapshots) {
  for_all([](Settings settings) {
    World world(several(), settings), late(several(), settings);
    settings.threads = 2;
    World two(several(), settings);
    for (World* const each : {&world, &two}) {
      test::run(*each, frame, 10);
      each->free(5);
      each->join({.a = 9, .b = 2, .length = norm(each->position(9) - each->position(2))});
      test::run(*each, frame, 10);
    }
    EXPECT_EQ(world.state_hash(), two.state_hash());
    std::vector<std::byte> bytes(world.snapshot_size());
    world.save(bytes);
    late.restore(bytes);
    for (World* const each : {&world, &two, &late}) {
      each->cut(16);
      test::run(*each, frame, 20);
    }
    EXPECT_EQ(world.state_hash(), late.state_hash());
    EXPECT_EQ(world.state_hash(), two.state_hash());
  });
}

// Islands with shapes that get rods that give are moved by the contact solver from then on.
TEST(MeetingEdits, BringTogetherWhatGives) {
  for_all([](const Settings& settings) {
    Scene scene = several();
    for (std::uint32_t i = 12; i < 16; ++i) scene.rods[i].law = {.stiffness = 100, .damping = 1};
    World world(scene, settings);
    world.join({.a = 9, .b = 2, .law = {.stiffness = 10}});
    test::run(world, frame, 3);
    scene.rods.push_back({.a = 9, .b = 2, .law = {.stiffness = 10}});
    EXPECT_EQ(world.info().islands, World(scene, settings).info().islands);
    step_beside(world, world.scene(), settings);
    world.join({.a = 19, .b = 2});
    world.free(5);
    test::run(world, frame, 3);
    EXPECT_EQ(world.info().islands, 2u);
    step_beside(world, world.scene(), settings);
    EXPECT_TRUE(world.problems().empty());
  });
}

TEST(MeetingEdits, RefuseToFreeGround) {
  Scene scene = several();
  scene.particles.push_back({.position = {5, 0, 0}, .fixed = true});
  scene.particles.push_back({.position = {5.1, 0, 0}, .fixed = true});
  scene.capsules.push_back({.a = point_at(20), .b = point_at(21), .radius = 0.02});
  World world(scene, {});
  world.set_mass(20, 1);
  expect_refusal("particle 20: a capsule of the ground is at it", [&] { world.free(20); });
}

TEST(MeetingEdits, RefuseTackles) {
  Scene scene = several();
  scene.tackles.push_back({.particles = {16, 17, 18}, .length = 1, .law = {.one_sided = true}});
  World world(scene, {});
  expect_refusal("islands with shapes or joints would come together with tackle 0",
                 [&] { world.join({.a = 19, .b = 2}); });
}

// What stays of rods, or lies between fixed particles, gives as well, whatever is ordered first.
TEST(MeetingEdits, KnowWhatWouldGive) {
  Scene scene = several();
  for (std::uint32_t i = 12; i < 16; ++i) scene.rods[i].mass = 0.1;
  const Settings settings{.method = Method::direct,
                          .gradient = Gradient::mid,
                          .mass = MassModel::consistent,
                          .substeps = 4,
                          .threads = 1};
  World world(scene, settings);
  world.join({.a = 19, .b = 2});
  world.cut(14);
  test::run(world, frame, 3);
  step_beside(world, world.scene(), settings);
  World between(several(), settings);
  between.join({.a = 16, .b = 18, .law = {.stiffness = 100}});
  between.step(frame);
  for (const std::uint32_t particle : {16u, 17u, 18u, 19u}) between.fix(particle);
  between.step(frame);
  between.join({.a = 16, .b = 2});
  between.step(frame);
  between.free(16);
  test::run(between, frame, 3);
  step_beside(between, between.scene(), settings);
}

// A rod that is cut leaves its mass, which joins its ends, whatever lies on its island.
TEST(MeetingEdits, CutRodsWithMassAlongThem) {
  Scene scene = several();
  for (Rod& rod : scene.rods) rod.mass = 0.1;
  const Settings settings{.method = Method::direct,
                          .gradient = Gradient::mid,
                          .mass = MassModel::consistent,
                          .substeps = 4,
                          .threads = 1};
  World world(scene, settings);
  test::run(world, frame, 3);
  world.cut(1);
  world.cut(6);
  test::run(world, frame, 1);
  EXPECT_EQ(world.info().islands, 4u);
  step_beside(world, world.scene(), settings);
  test::run(world, frame, 30);
  EXPECT_GT(norm(world.position(7) - world.position(8)), 0.11);
}

// Another mass model keeps the ends of a cut rod together, which a joined rod leads to shapes.
TEST(MeetingEdits, AreAskedAgainByOtherSettings) {
  Scene scene = several();
  for (std::uint32_t i = 12; i < 16; ++i) scene.rods[i].mass = 0.1;
  World world(scene, {.method = Method::relax, .threads = 1});
  test::run(world, frame, 3);
  world.cut(14);
  test::run(world, frame, 3);
  world.join({.a = 19, .b = 2, .length = norm(world.position(19) - world.position(2))});
  test::run(world, frame, 3);
  for (const MassModel mass : {MassModel::consistent, MassModel::lumped}) {
    const std::vector<Vec3> before = test::positions_of(world);
    world.set_settings({.method = Method::direct, .mass = mass, .threads = 1});
    EXPECT_EQ(test::positions_of(world), before);
    test::run(world, frame, 3);
    EXPECT_EQ(world.info().islands, mass == MassModel::lumped ? 4u : 3u);
    EXPECT_TRUE(world.problems().empty());
  }
}

// What was one rope until its middle was fixed has neighbours there still. Ropes at places of their own that
// coincide have not.
TEST(MeetingEdits, LeaveNeighboursAtAnAnchorAlone) {
  for_all([](const Settings& settings) {
    Scene scene;
    scene.gravity = {};
    add_rope(scene, {}, {1, 0, 0}, false);
    World world(scene, settings);
    world.fix(2);
    world.step(frame);
    EXPECT_EQ(world.info().islands, 2u);
    EXPECT_TRUE(world.contacts().empty());
    add_rope(scene, scene.particles[2].position, {0, 0, 1}, true);
    World apart(scene, settings);
    apart.step(frame);
    EXPECT_FALSE(apart.contacts().empty());
  });
}

}  // namespace
}  // namespace plumb::PLUMB_TEST_FILE
