// What grabs do beside pulling: several of them in snapshots, on free figures that are braked, with equal
// weights, as forces jump, and where one ends that did nothing.

#include <gtest/gtest.h>

#include <cmath>
#include <cstdint>

#include "plumb/plumb.hpp"
#include "scenes/generators/generators.hpp"
#include "support/refusals.hpp"
#include "support/snapshots.hpp"
#include "support/worlds.hpp"

namespace plumb::PLUMB_TEST_FILE {
namespace {

using test::movable;
using test::refusal;

/// Figures of three particles, of which a spring holds the ends together.
Scene sprung(std::uint32_t figures) {
  Scene scene;
  for (std::uint32_t i = 0; i < figures; ++i) {
    const std::uint32_t first = 3 * i;
    for (const Vec3 at : {Vec3{}, Vec3{0.3, 0.1, 0}, Vec3{0.6, 0, 0.1}})
      scene.particles.push_back(movable(at + Vec3{2.0 * i, 0, 0}));
    scene.rods.push_back({.a = first, .b = first + 1});
    scene.rods.push_back({.a = first + 1, .b = first + 2});
    scene.springs.push_back(
        {.a = {{first}, {1}}, .b = {{first + 2}, {1}}, .length = 0.5, .stiffness = 200, .damping = 2});
  }
  return scene;
}

// Numbers of grabs are given anew, so that their order is not that in which islands were grabbed.
TEST(GrabbedMotion, OfSeveralIsPartOfSnapshots) {
  const Settings settings{.sleep = false, .tensions = true};
  const Scene scene = sprung(2);
  World world(scene, settings), other(scene, settings);
  const auto at = [&](std::uint32_t particle) { return world.position(particle); };
  const Handle<Grab> first = world.grab(Grab::particle(1, at(1), 10));
  const Handle<Grab> b = world.grab(Grab::particle(4, at(4), 300, 3));
  world.release(first);
  const Handle<Grab> a0 = world.grab(Grab::particle(0, at(0), 2000, 20));
  const Handle<Grab> a2 = world.grab(Grab::particle(2, at(2), 100, 1));
  test::run(world, 1.0 / 60, 10);
  const test::Snapshot bytes = test::snapshot_of(world);
  other.restore(bytes);
  EXPECT_EQ(test::snapshot_of(other), bytes);
  world.restore(bytes);
  World straight(scene, settings);  // never restored
  ASSERT_EQ(straight.grab(Grab::particle(1, straight.position(1), 10)), first);
  ASSERT_EQ(straight.grab(Grab::particle(4, straight.position(4), 300, 3)), b);
  straight.release(first);
  ASSERT_EQ(straight.grab(Grab::particle(0, straight.position(0), 2000, 20)), a0);
  ASSERT_EQ(straight.grab(Grab::particle(2, straight.position(2), 100, 1)), a2);
  test::run(straight, 1.0 / 60, 10);
  for (int i = 0; i < 30; ++i) {
    for (World* const each : {&world, &other, &straight}) {
      each->move_grab(b, {2.3, 0.02 * i, 0});
      each->move_grab(a2, {0.6, 0, 0.01 * i});
      each->step(1.0 / 60);
    }
    ASSERT_EQ(world.state_hash(), straight.state_hash()) << i;
    ASSERT_EQ(other.state_hash(), straight.state_hash()) << i;
    EXPECT_EQ(other.grab_force(a0), straight.grab_force(a0));
  }
}

// The target of a grab is nothing that a figure hangs from: joint drag brakes what its parts do to each other
// alone.
TEST(GrabbedMotion, IsNotBrakedAsThatOfWhatHangs) {
  Scene scene = sprung(1);
  scene.joint_drag = 5;
  for (const Method method : {Method::relax, Method::direct}) {
    World grabbed(scene, {.method = method, .sleep = false}), free(scene, {.method = method, .sleep = false});
    grabbed.grab(Grab::particle(1, grabbed.position(1), 1e-6));
    test::run(grabbed, 1.0 / 60, 60);
    test::run(free, 1.0 / 60, 60);
    EXPECT_LT(free.position(1).y, -4) << "it falls freely";
    // The spring takes micronewtons, and being elastic, another way of solving.
    EXPECT_NEAR(grabbed.position(1).y, free.position(1).y, 1e-4) << to_string(method);
  }
}

TEST(GrabbedMotion, OfWhatIsFreedBeginsAfterTheStep) {
  for (const Method method : {Method::relax, Method::direct}) {
    World world(scenes::make_chain(4, 0.1, 2), {.method = method, .tensions = true});
    world.fix(4);
    world.step(1.0 / 60);
    world.free(4);
    EXPECT_EQ(refusal([&] { world.grab(Grab::particle(4, {}, 10)); }),
              "grab: particle 4 is free from the next step on; grab it then");
    world.step(1.0 / 60);
    const Handle<Grab> grab = world.grab(Grab::particle(4, world.position(4), 1000, 10));
    test::run(world, 1.0 / 60, 10);
    EXPECT_TRUE(test::all_finite(world));
    EXPECT_GT(norm(world.grab_force(grab)), 1);
  }
}

// With equal weights, too, sweeps do not move what is held.
TEST(GrabbedMotion, IsHeldWithEqualWeights) {
  for (const Gradient gradient : {Gradient::new_, Gradient::mid}) {
    World world(scenes::make_chain(4, 0.1, 2),
                {.method = Method::relax, .gradient = gradient, .weights = Weights::equal, .substeps = 4});
    const Handle<Grab> grab = world.grab(Grab::particle(4, world.position(4), 1e9, 1e5));
    for (int i = 1; i <= 60; ++i) {
      const Vec3 target = Vec3{0.4 - 0.001 * i, 0, 0};
      world.move_grab(grab, target);
      world.step(1.0 / 60);
      EXPECT_LT(norm(world.position(4) - target), 1e-6) << i << to_string(gradient);
    }
  }
}

/// Where a relaxed particle is that is pulled to a target that moves, as forces, gravity and the number of
/// substeps jump.
Vec3 jolted(Gradient gradient, std::uint32_t substeps) {
  Scene one;
  one.particles = {movable({})};
  World world(one, {.method = Method::relax, .gradient = gradient, .substeps = substeps, .sleep = false});
  const Handle<Grab> grab = world.grab(Grab::particle(0, {0.1, 0, 0}, 2000, 15));
  for (int i = 0; i < 40; ++i) {
    if (i % 8 == 3) world.set_force(0, {i % 16 == 3 ? 100.0 : -20.0, 5, 0});
    if (i % 8 == 6) world.set_gravity({0, i % 16 == 6 ? -9.81 : 30, 0});
    world.move_grab(grab, {0, 0, 0.01 * (i % 7)});
    world.set_substeps(i % 2 == 0 ? 2 * substeps : substeps);
    world.step(1.0 / 60);
  }
  return world.position(0);
}

// Displacements of old and new know the forces of their substep. What jumps there changes them by what it
// does to the heavier particle that a substep sees; otherwise the order would be lost.
TEST(GrabbedMotion, KeepsItsOrderAsForcesJump) {
  const Vec3 truth = jolted(Gradient::mid, 2048);  // good to 1e-9 m, by its order
  for (const Gradient gradient : {Gradient::new_, Gradient::old, Gradient::mid}) {
    const double coarse = norm(jolted(gradient, 16) - truth), fine = norm(jolted(gradient, 32) - truth);
    EXPECT_GT(std::log2(coarse / fine), gradient == Gradient::new_ ? 0.9 : 1.9) << to_string(gradient);
    EXPECT_LT(fine, gradient == Gradient::new_ ? 3e-3 : 3e-5) << to_string(gradient);
  }
}

TEST(GrabbedMotion, HasItsBitsWhereOneEndsThatDidNothing) {
  const Scene ring = scenes::make_ring({});
  std::uint32_t particle = 1;
  while (ring.particles[particle].fixed) ++particle;
  for (const Gradient gradient : {Gradient::old, Gradient::mid}) {
    const Settings settings{.method = Method::direct, .gradient = gradient, .sleep = false};
    World with(ring, settings), without(ring, settings);
    const Handle<Grab> grab = with.grab(Grab::particle(particle, {}, 0));
    test::run(with, 1.0 / 60, 10);
    with.release(grab);
    test::run(with, 1.0 / 60, 10);
    test::run(without, 1.0 / 60, 20);
    EXPECT_EQ(with.state_hash(), without.state_hash()) << to_string(gradient);
  }
}

}  // namespace
}  // namespace plumb::PLUMB_TEST_FILE
