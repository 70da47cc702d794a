// Handles of grabs, what refuses them, what ends them, and what they leave alone.

#include "step/inputs/grabs.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <cstdint>
#include <limits>
#include <string>
#include <vector>

#include "interface/grab.hpp"
#include "plumb/plumb.hpp"
#include "scenes/generators/generators.hpp"
#include "scenes/humanoid/humanoid.hpp"
#include "support/executors.hpp"
#include "support/refusals.hpp"
#include "support/snapshots.hpp"
#include "support/worlds.hpp"

namespace plumb::PLUMB_TEST_FILE {
namespace {

using test::movable;
using test::refusal;

constexpr double nan = std::numeric_limits<double>::quiet_NaN();

Particle fixed_at(Vec3 position) {
  return {.position = position, .fixed = true};
}

// The formulas by themselves: one substep of a mass m alone, from rest. New is backward Euler,
// d (m + h²k + hc) = h² k T. Mid takes the middle, d (m + h²k/4 + hc/2) = h²/2 k T. Old has, after a
// displacement u, d (m + h²k/4 + hc/2) = m u + h² k T + h²k u/4 - h c u/2.
TEST(GrabSubsteps, AreThoseOfTheirSchemes) {
  constexpr double m = 2, k = 30, c = 0.4, h = 0.05, t = 0.7, u = 0.01;
  detail::HeldGrab grab;
  grab.stiffness = k;
  grab.damping = c;
  grab.target = {t, 0, 0};
  const auto moved = [&](Gradient gradient, double kick, double before) {
    const auto substep = detail::GrabSubstep::begin(grab, gradient, m, {}, {before, 0, 0}, h);
    const double heavier = m + kick * substep.stiff;
    return before + kick * substep.force.x / heavier;
  };
  EXPECT_NEAR(moved(Gradient::new_, h * h, 0), h * h * k * t / (m + h * h * k + h * c), 1e-15);
  EXPECT_NEAR(moved(Gradient::mid, h * h / 2, 0), h * h / 2 * k * t / (m + h * h * k / 4 + h * c / 2), 1e-15);
  EXPECT_NEAR(moved(Gradient::old, h * h, u),
              (m * u + h * h * k * t + h * h * k * u / 4 - h * c * u / 2) / (m + h * h * k / 4 + h * c / 2),
              1e-15);
  // What no substep resolves is where the target is at its end.
  grab.stiffness = 1e14;
  grab.velocity = {3, 0, 0};
  for (const Gradient gradient : {Gradient::new_, Gradient::old, Gradient::mid})
    EXPECT_NEAR(moved(gradient, gradient == Gradient::mid ? h * h / 2 : h * h, u), t + 3 * h, 1e-9);
}

TEST(Grabs, AreRefusedWithTheReason) {
  Scene scene = scenes::make_chain(4, 0.1, 2);
  scene.particles.push_back(movable({5, 0, 0}));
  World world(scene, {.method = Method::direct});
  const std::uint64_t before = world.state_hash();
  const auto said = [&](const Grab& grab) { return refusal([&] { world.grab(grab); }); };
  EXPECT_EQ(said(Grab::particle(9, {}, 1)), "particle 9: unknown, the world has 6 particles");
  EXPECT_EQ(said(Grab::particle(0, {}, 1)),
            "grab: its place is fixed, and a grab cannot move it; move_anchor() does");
  EXPECT_EQ(said(Grab::particle(1, {}, -2)), "grab: stiffness must be finite and not negative, got -2 N/m");
  EXPECT_EQ(said(Grab::particle(1, {}, nan)), "grab: stiffness must be finite and not negative, got nan N/m");
  EXPECT_EQ(said(Grab::particle(1, {}, 2, -1)),
            "grab: damping must be finite and not negative, got -1 N s/m");
  EXPECT_EQ(said(Grab::particle(1, {0, nan, 0}, 2)), "grab: target is not finite");
  EXPECT_EQ(said({{{1, 2}, {0.5, 0.6}}, {}, 1}), "grab: weights of its place must add up to 1, and make 1.1");
  EXPECT_EQ(said({{{1, 1}, {0.5, 0.5}}, {}, 1}), "grab: its place lists particle 1 twice");
  EXPECT_EQ(said({{{1, 5}, {0.5, 0.5}}, {}, 1}), "grab 0: its place is of more than one island");
  EXPECT_EQ(said(Grab::rod(scene.rods[1], 0.5, {}, 1)),
            "grab 0: its place is between particles, and the masses of its island are all in these; grab one "
            "of them");
  EXPECT_EQ(refusal([&] { world.move_grab({}, {}); }), "grab: the handle names none");
  EXPECT_EQ(refusal([&] {
              world.release({0, 1});
            }),
            "grab 0: the handle, of generation 1, is not of this world");
  EXPECT_EQ(world.state_hash(), before);
  World relaxed(scene, {.method = Method::relax});
  EXPECT_EQ(refusal([&] { relaxed.grab(Grab::rod(scene.rods[1], 0.5, {}, 1)); }),
            "grab 0: its place is between particles, which relaxation moves one by one; grab one of them, or "
            "solve directly");
  World springs(scene, {.method = Method::springs});
  EXPECT_EQ(refusal([&] { springs.grab(Grab::particle(1, {}, 1)); }),
            "grab 0: its place is moved by a method that takes no grabs; relax, direct and auto do");
  const Handle<Grab> grab = world.grab(Grab::particle(1, {}, 1));
  EXPECT_EQ(refusal([&] { world.move_grab(grab, {nan, 0, 0}); }), "grab: target is not finite");
  EXPECT_EQ(refusal([&] { world.grab_force(grab); }),
            "tensions are not known: Settings::tensions asks for them");
  world.release(grab);
  EXPECT_FALSE(world.has(grab));
  EXPECT_EQ(refusal([&] { world.release(grab); }),
            "grab 0: was released; its handle is of generation 1, now 2");
}

// A grab ends with its particle: where that is removed, or fixed. One of a rope that is cut stays with its
// part. Numbers are given anew, and stale handles are refused.
TEST(Grabs, EndWithTheirParticles) {
  Scene scene = scenes::make_chain(6, 0.1, 2);
  World world(scene, {.method = Method::direct, .sleep = false, .tensions = true});
  const Added other = world.add(scenes::make_chain(3, 0.1, 1));
  const Handle<Grab> removed = world.grab(Grab::particle(other.particle + 2, {1, 1, 1}, 50));
  const Handle<Grab> stays = world.grab(Grab::particle(6, {0, 1, 0}, 5000, 50));
  const Handle<Grab> fixed = world.grab(Grab::particle(4, {0, 1, 0}, 10));
  test::run(world, 1.0 / 60, 3);
  world.remove(other.particle + 2);
  EXPECT_FALSE(world.has(removed));
  world.cut(3);
  world.fix(4);
  test::run(world, 1.0 / 60, 1);
  EXPECT_FALSE(world.has(fixed));
  ASSERT_TRUE(world.has(stays));
  const Handle<Grab> again = world.grab(Grab::particle(5, {}, 1));
  EXPECT_EQ(again.number, removed.number);
  EXPECT_NE(again, removed);
  world.free(4);
  test::run(world, 1.0 / 60, 240);
  // Three links hang from the grab: 1 + 1 + 2 kg, of which the last is held.
  EXPECT_NEAR(world.grab_force(stays).y, 4 * 9.81, 4);
}

// Without stiffness and damping a grab is nothing.
TEST(Grabs, WithoutStiffnessDoNothing) {
  const Scene scene = scenes::make_tree();
  for (const Method method : {Method::relax, Method::direct}) {
    World with(scene, {.method = method}), without(scene, {.method = method});
    with.grab(Grab::particle(3, {4, 4, 4}, 0));
    test::run(with, 1.0 / 60, 60);
    test::run(without, 1.0 / 60, 60);
    EXPECT_EQ(with.state_hash(), without.state_hash());
  }
}

// A sleeping island wakes as it is grabbed, or as the target moves, and may sleep while it stands.
TEST(Grabs, WakeWhatSleeps) {
  Scene chain;
  chain.particles = {fixed_at({0, 1, 0}), movable({0, 0, 0})};
  chain.rods = {{.a = 0, .b = 1}};
  for (const Method method : {Method::relax, Method::direct}) {
    World world(chain, {.method = method, .sleep = true});
    test::run(world, 1.0 / 60, 60);
    ASSERT_EQ(world.step(1.0 / 60).awake_islands, 0u);
    const Handle<Grab> grab = world.grab(Grab::particle(1, {0, 0, 0}, 100, 200));
    EXPECT_EQ(world.step(1.0 / 60).awake_islands, 1u);
    test::run(world, 1.0 / 60, 200);
    ASSERT_EQ(world.step(1.0 / 60).awake_islands, 0u);
    for (int i = 1; i <= 60; ++i) {
      world.move_grab(grab, {0.002 * i, 0, 0});
      EXPECT_EQ(world.step(1.0 / 60).awake_islands, 1u);
    }
    EXPECT_GT(world.position(1).x, 0.01);
  }
  const Scene figure = scenes::make_humanoid({.body = scenes::BodyType::medium});
  World world(figure, {});
  ASSERT_EQ(world.step(1.0 / 60).awake_islands, 0u);
  const Handle<Grab> grab = world.grab(Grab::particle(0, world.position(0), 1000, 100));
  EXPECT_EQ(world.step(1.0 / 60).awake_islands, 1u);
  world.release(grab);
}

Scene crowd_of(const Scene& one, std::uint32_t count) {
  Scene out = one;
  for (std::uint32_t i = 1; i < count; ++i) {
    const auto first = static_cast<std::uint32_t>(out.particles.size());
    for (Particle particle : one.particles) {
      particle.position += Vec3{3.0 * i, 0, 0};
      out.particles.push_back(particle);
    }
    for (Rod rod : one.rods) {
      rod.a += first;
      rod.b += first;
      out.rods.push_back(rod);
    }
  }
  return out;
}

// Equal figures lie side by side in lanes. Where one of them is grabbed, all stay where they lie, and the
// others keep their bits; once let go, it falls as one that never was.
TEST(Grabs, LeaveNeighborsTheirBitsAndLanes) {
  const Scene one = scenes::make_humanoid();
  constexpr std::uint32_t count = 20, held = 3;
  const Scene crowd = crowd_of(one, count);
  const auto size = static_cast<std::uint32_t>(one.particles.size());
  for (const Method method : {Method::relax, Method::direct})
    for (const Gradient gradient : {Gradient::new_, Gradient::old, Gradient::mid})
      for (const Precision precision : {Precision::single, Precision::double_}) {
        const Settings settings{
            .method = method, .precision = precision, .gradient = gradient, .substeps = 2};
        World world(crowd, settings), free(crowd, settings);
        const Handle<Grab> grab =
            world.grab(Grab::particle(held * size + 6, world.position(held * size + 6), 3000, 10));
        const auto blocks = [](const World& of) { return of.info().blocks.size(); };
        EXPECT_EQ(blocks(world), blocks(free));
        for (int i = 1; i <= 90; ++i) {
          if (i == 60) world.release(grab);
          world.step(1.0 / 60);
          free.step(1.0 / 60);
        }
        for (std::uint32_t p = 0; p < crowd.particles.size(); ++p) {
          if (p / size == held) continue;
          ASSERT_EQ(world.position(p), free.position(p)) << p << to_string(method) << to_string(gradient);
          ASSERT_EQ(world.velocity(p), free.velocity(p)) << p << to_string(method) << to_string(gradient);
        }
        EXPECT_NE(world.position(held * size + 6), free.position(held * size + 6));
      }
}

// What a player does with grabs, by the frame alone.
void play(World& world, std::uint32_t particle, std::vector<Handle<Grab>>& grabs, int frame) {
  if (frame % 20 == 5)
    grabs.push_back(world.grab(Grab::particle(particle, world.position(particle), 500, 5)));
  if (!grabs.empty() && frame % 20 < 15)
    world.move_grab(grabs.back(), world.position(particle) + Vec3{0.01, 0.02, 0.003 * (frame % 7)});
  if (frame % 20 == 15 && !grabs.empty()) {
    world.release(grabs.back());
    grabs.pop_back();
  }
}

// Saved while something is grabbed and its target is on its way, a world goes on to the bit, whatever is
// grabbed in the one that is restored.
TEST(Grabs, ArePartOfSnapshots) {
  Scene jointed = scenes::make_humanoid({.body = scenes::BodyType::medium, .arms = 1});
  const Scene scenes_of[] = {scenes::make_humanoid(), scenes::make_ring({}), jointed};
  for (const Scene& scene : scenes_of)
    for (const Method method : {Method::relax, Method::direct}) {
      const Settings settings{.method = method, .tensions = true};
      World world(scene, settings), other(scene, settings);
      std::uint32_t particle = 3;
      while (scene.particles[particle].fixed) ++particle;
      std::vector<Handle<Grab>> grabs;
      for (int i = 0; i < 31; ++i) {
        play(world, particle, grabs, i);
        world.step(1.0 / 60);
      }
      ASSERT_FALSE(grabs.empty());
      other.grab(Grab::particle(particle + 1, {}, 10));
      test::run(other, 1.0 / 60, 3);
      const test::Snapshot bytes = test::snapshot_of(world);
      other.restore(bytes);
      EXPECT_EQ(test::snapshot_of(other), bytes);
      std::vector<Handle<Grab>> same = grabs;
      for (int i = 31; i < 80; ++i) {
        play(world, particle, grabs, i);
        play(other, particle, same, i);
        world.step(1.0 / 60);
        other.step(1.0 / 60);
        ASSERT_EQ(world.state_hash(), other.state_hash()) << i << ' ' << to_string(method);
      }
      EXPECT_EQ(test::snapshot_of(other), test::snapshot_of(world));
    }
}

}  // namespace
}  // namespace plumb::PLUMB_TEST_FILE
