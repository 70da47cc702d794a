// Edits of one step that touch each other, and what snapshots make of them.

#include <gtest/gtest.h>

#include <cstddef>
#include <cstdint>
#include <vector>

#include "plumb/plumb.hpp"
#include "support/edited_worlds.hpp"
#include "support/figures.hpp"
#include "support/worlds.hpp"

namespace plumb::PLUMB_TEST_FILE {
namespace {

using test::expect_refusal;

constexpr double frame = 1.0 / 60;

/// A rope that hangs from its first particle.
Scene rope(bool has_shapes) {
  Scene scene;
  for (std::uint32_t i = 0; i <= 3; ++i)
    scene.particles.push_back({.position = {0.1 * i, 1, 0}, .mass = 0.1, .fixed = i == 0});
  for (std::uint32_t i = 0; i < 3; ++i) {
    scene.rods.push_back({.a = i, .b = i + 1, .length = 0.1});
    if (has_shapes) scene.capsules.push_back({.a = point_at(i), .b = point_at(i + 1), .radius = 0.01});
  }
  return scene;
}

/// Expects a fresh world to go on from a snapshot with equal bytes.
void expect_restored(World& world, const Scene& scene) {
  const auto saved = [](const World& of) {
    std::vector<std::byte> out(of.snapshot_size());
    of.save(out);
    return out;
  };
  World other(scene, world.settings());
  other.restore(saved(world));
  world.step(frame);
  other.step(frame);
  EXPECT_EQ(saved(other), saved(world));
}

// One end of a spring is freed and the other one fixed.
TEST(EditedTogether, FreeWhatHoldsBeforeTheRestIsFixed) {
  Scene scene = rope(true);
  scene.springs.push_back({.a = point_at(0), .b = point_at(2), .length = 0.15, .stiffness = 20});
  World world(scene, {});
  world.step(frame);
  world.free(0);
  world.fix(2);
  world.step(frame);
  EXPECT_LT(world.position(0).y, 0.9999);
  expect_restored(world, scene);
}

// A hook between two ropes has the mass of a rod to the anchor of one, and goes with that and its rope.
TEST(EditedTogether, LeaveWhatIsFreedTheMassOfARodBetweenAnchors) {
  Scene scene;
  scene.particles = {{.position = {0, 2, 0}, .mass = 1},
                     {.position = {0, 1, 0}, .mass = 1},
                     {.position = {1, 2, 0}, .fixed = true},
                     {.position = {1, 1, 0}, .mass = 1},
                     {.position = {2, 2, 0}, .fixed = true}};
  scene.rods = {{.a = 0, .b = 1}, {.a = 2, .b = 3}, {.a = 4, .b = 3}, {.a = 2, .b = 0, .mass = 0.2}};
  World world(scene, {});
  world.fix(0);
  world.step(frame);
  world.free(2);
  expect_refusal("particle 2: has no mass to be free with", [&] { world.remove(1); });
  world.step(frame);
  EXPECT_LT(world.velocity(2).y, 0);
}

// A rope hangs from a corner of a crate that is to be free, and without the crate it would hang from nothing.
TEST(EditedTogether, LeaveWhatIsFreedItsMass) {
  Scene scene = test::crate({0, 2, 0});
  scene.particles.push_back({.position = {0.5, 2, 0}, .mass = 0.1});
  World world(scene, {});
  world.join({.a = 0, .b = 4});
  world.fix(0);
  world.step(frame);
  world.free(0);
  expect_refusal("particle 0: has no mass to be free with", [&] { world.remove(1); });
  world.set_mass(0, 0.2);
  world.remove(1);
  world.step(frame);
  EXPECT_TRUE(world.has(world.handle<Particle>(0)));
  EXPECT_LT(world.velocity(0).y, 0);
  EXPECT_TRUE(world.problems().empty());
}

// A ball is tied to an anchor and fixed in the same step. Nothing moves it then.
TEST(EditedTogether, FixWhatIsJoined) {
  Scene scene = rope(true);
  scene.particles.push_back({.position = {0, 0.5, 0.5}, .mass = 0.2});
  scene.capsules.push_back({.a = point_at(4), .b = point_at(4), .radius = 0.05});
  World world(scene, {});
  world.join({.a = 0, .b = 4});
  world.fix(4);
  for (int i = 0; i < 10; ++i) world.step(frame);
  EXPECT_EQ(world.position(4), scene.particles[4].position);
  EXPECT_EQ(world.info().islands, 1u);
  expect_restored(world, scene);
}

// Nothing moves a body's rod while both its ends are fixed. It is not cut then, either.
TEST(EditedTogether, KeepBodiesWhole) {
  World world(test::crate({0, 1, 0}), {});
  world.fix(0);
  world.fix(1);
  world.step(frame);
  for (std::uint32_t rod = 0; rod < 6; ++rod)
    expect_refusal("is of a body, which stays whole", [&] { world.cut(rod); });
}

// A bare rope may wind rods that give, and one with joints may not. What comes second is refused.
TEST(EditedTogether, WindNothingThatGivesAmongJoints) {
  Scene scene = rope(false);
  scene.rods[1].law.one_sided = true;
  const std::uint32_t box = 4;
  test::add_crate(scene, {2, 1, 0});
  World world(scene, {});
  world.step(frame);
  world.set_length(1, 0.101);
  expect_refusal("rod 1 would change its length in the next step and give, bend or drag",
                 [&] { world.join({.a = 3, .b = box}); });
  world.step(frame);
  world.join({.a = 3, .b = box});
  expect_refusal("rod 1: its length cannot change, since its island has joints or shapes in the next step",
                 [&] { world.set_length(1, 0.102); });
  for (int i = 0; i < 10; ++i) world.step(frame);
  EXPECT_LE(norm(world.position(1) - world.position(2)), 0.101 + 1e-9);
  EXPECT_TRUE(test::all_finite(world));
}

// A rod with mass along it stops in the step in which it is cut: its mass alone is left.
TEST(EditedTogether, CutWhatWasWound) {
  Scene scene = rope(true);
  for (Rod& rod : scene.rods) rod.mass = 0.1;
  World world(scene, {.method = Method::direct});
  world.step(frame);
  world.set_length(1, 0.101);
  world.step(frame);
  world.set_length(1, 0.102);
  world.cut(1);
  for (int i = 0; i < 10; ++i) world.step(frame);
  EXPECT_TRUE(test::all_finite(world));
  EXPECT_LT(world.position(3).y, 0.9);
  expect_restored(world, scene);
}

// Numbers of bodies that were removed go to others after an edit, which a snapshot does again.
TEST(EditedTogether, RestoreBodiesThatTakeNumbers) {
  Scene scene = test::crate({0, 2, 0});
  test::add_figure(scene, {1.4, 1, 0});
  test::add_figure(scene, {0, 2, 0.7});
  Scene ball;
  ball.particles.push_back({.position = {3, 2, 1}, .mass = 0.2});
  ball.capsules.push_back({.a = point_at(0), .b = point_at(0), .radius = 0.05});
  World world(scene, {.tensions = true});
  world.remove(4);
  world.add(ball);
  world.fix(17);
  world.step(frame);
  world.add(test::crate({2, 1, 1}));
  expect_restored(world, scene);
}

// A capsule alone holds the rest of a rope at a particle that is freed.
TEST(EditedTogether, GiveHomesToWhatCapsulesHold) {
  Scene scene = rope(true);
  scene.capsules.push_back({.a = {{0, 1, 2, 0}, {0.4, 0.3, 0.3, 0}}, .b = point_at(0), .radius = 0.03});
  World world(scene, {});
  world.fix(1);
  world.step(frame);
  world.free(0);
  for (int i = 0; i < 10; ++i) world.step(frame);
  EXPECT_LT(world.position(0).y, 0.95);
  EXPECT_TRUE(test::all_finite(world));
  expect_restored(world, scene);
}

// Reactions forget an anchor that is freed with a rod that was cut.
TEST(EditedTogether, ForgetAnchorsThatAreFreed) {
  Scene scene = rope(true);
  scene.particles.push_back({.position = {2, 1, 0}, .mass = 0.1});
  World world(scene, {.tensions = true});
  world.cut(0);
  world.step(frame);
  world.move_anchor(0, {0.01, 1, 0});
  world.free(0);
  world.step(frame);
  expect_restored(world, scene);
}

}  // namespace
}  // namespace plumb::PLUMB_TEST_FILE
