// Reactions: what holds anchors, at rest and in motion.

#include "step/reactions.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <vector>

#include "plumb/plumb.hpp"
#include "support/reactions.hpp"
#include "support/refusals.hpp"
#include "support/worlds.hpp"

namespace plumb::PLUMB_TEST_FILE {
namespace {

using test::fixed;
using test::movable;
using test::sum_of_reactions;

constexpr double g = 9.81;

/// A line of `rods` rods with mass between two anchors 1.5 m apart that sags.
Scene hammock(std::uint32_t rods, double mass) {
  Scene scene;
  for (std::uint32_t i = 0; i <= rods; ++i) {
    const double s = static_cast<double>(i) / rods;
    const Vec3 at{1.5 * s, -2 * s * (1 - s), 0};
    scene.particles.push_back(i == 0 || i == rods ? fixed(at) : movable(at, 0.1));
    if (i > 0) scene.rods.push_back({.a = i - 1, .b = i, .mass = mass});
  }
  return scene;
}

TEST(Reactions, CarryTheWholeWeightAtRest) {
  for (const double mass : {0.0, 0.5})
    for (const bool has_loop : {false, true}) {
      Scene scene = hammock(6, mass);
      scene.drag = 10;
      if (has_loop) scene.rods.push_back({.a = 2, .b = 4, .law = {.stiffness = 100}});
      World world(scene, {.method = Method::direct, .tensions = true});
      test::run(world, 1.0 / 60, 3000);
      const double weight = (5 * 0.1 + 6 * mass) * g;
      EXPECT_LT(norm(sum_of_reactions(world) - Vec3{0, weight, 0}), 1e-9 * weight) << mass << has_loop;
      EXPECT_NEAR(world.reaction(0).y, weight / 2, 1e-9 * weight);
      EXPECT_LT(world.reaction(0).x, 0);
    }
}

/// The largest difference, over the steps of a second, between what forces do and the change of momentum.
/// `before_step(world, number)` is called before every step.
template <class BeforeStep>
double imbalance(const Scene& scene, const Settings& settings, int steps, Vec3 push,
                 BeforeStep&& before_step) {
  World world(scene, settings);
  world.set_force(2, push);
  const MassModel model = mass_model_of(settings);
  double weight = 0;
  for (const Particle& particle : scene.particles) weight += particle.mass * g;
  for (const Rod& rod : scene.rods) weight += rod.mass * g;
  const auto momentum = [&] {
    return measure_momentum(scene, test::positions_of(world), test::velocities_of(world), model).linear;
  };
  const double dt = 1.0 / steps;
  double worst = 0;
  Vec3 last = momentum();
  for (int i = 0; i < steps; ++i) {
    before_step(world, i);
    world.step(dt);
    const Vec3 now = momentum();
    worst =
        std::max(worst, norm(1 / dt * (now - last) - (sum_of_reactions(world) + push - Vec3{0, weight, 0})));
    last = now;
  }
  return worst;
}
double imbalance(const Scene& scene, const Settings& settings, int steps, Vec3 push) {
  return imbalance(scene, settings, steps, push, [](World&, int) {});
}

TEST(Reactions, MakeTheChangeOfMomentum) {
  Scene scene = hammock(3, 0.5);
  scene.particles.back().fixed = false;  // it swings from its first anchor
  scene.particles.back().mass = 0.3;
  const Vec3 push{0.5, 0.2, 0.1};
  for (const Gradient gradient : {Gradient::mid, Gradient::old})
    for (const std::uint32_t substeps : {1u, 3u})
      EXPECT_LT(
          imbalance(scene,
                    {.method = Method::direct, .gradient = gradient, .substeps = substeps, .tensions = true},
                    100, push),
          1e-9);
}

// An anchor that moves by jerks gives blows of some 60 N, which act along rods as a step begins.
TEST(Reactions, HoldTheBlowsOfAnAnchorThatJerks) {
  for (const bool gives : {false, true})
    for (const bool has_loop : {false, true}) {
      Scene scene = hammock(3, 0);
      scene.particles.back().fixed = false;
      scene.particles.back().mass = 0.3;
      if (gives)
        for (Rod& rod : scene.rods) rod.law = {.stiffness = 1e3, .damping = 1};
      if (has_loop) scene.rods.push_back({.a = 1, .b = 3, .law = {.stiffness = 50}});
      Vec3 at = scene.particles[0].position;
      const double off =
          imbalance(scene, {.method = Method::direct, .gradient = Gradient::mid, .tensions = true}, 100, {},
                    [&](World& world, int step) {
                      at += (step % 7 < 3 ? 0.01 : -0.004) * Vec3{0.3, step % 5 == 0 ? 1.0 : 0.5, 0.1};
                      world.move_anchor(0, at);
                    });
      EXPECT_LT(off, 1e-8) << gives << has_loop;
    }
}

// Lines that hang straight are towed up from the very first step on. Gradients old and new start from a
// velocity, where a blow displaces twice as far as the same impulse spread over a substep does.
TEST(Reactions, HoldABlowInTheFirstStepOnce) {
  for (const Gradient gradient : {Gradient::new_, Gradient::old, Gradient::mid})
    for (const Precision precision : {Precision::single, Precision::double_})
      for (const std::uint32_t links : {3u, 100u})  // a tree in lanes, and one line in segments
        for (const bool has_loop : {false, true}) {
          Scene scene;
          for (std::uint32_t i = 0; i <= links; ++i) {
            const Vec3 at{0, -0.1 * i, 0};
            scene.particles.push_back(i == 0 ? fixed(at) : movable(at, 0.2));
            if (i > 0) scene.rods.push_back({.a = i - 1, .b = i});
          }
          if (has_loop) {
            scene.particles.push_back(movable({0.05, -0.15, 0}, 0.2));
            for (const std::uint32_t end : {1u, 2u}) scene.rods.push_back({.a = end, .b = links + 1});
          }
          World world(scene, {.method = Method::direct,
                              .precision = precision,
                              .gradient = gradient,
                              .substeps = 2,
                              .tensions = true});
          constexpr double dt = 1.0 / 60, speed = 0.5;
          const double weight = 0.2 * g * (links + (has_loop ? 1 : 0));
          Vec3 before = measure_momentum(scene, test::positions_of(world), test::velocities_of(world)).linear;
          for (int i = 1; i <= 3; ++i) {
            world.move_anchor(0, {0, i * speed * dt, 0});
            world.step(dt);
            const Vec3 now =
                measure_momentum(scene, test::positions_of(world), test::velocities_of(world)).linear;
            const double force = (now - before).y / dt + weight;
            before = now;
            // Float solves for pulls to its rounding. A triangle turns in a substep, which old and new see
            // late. A blow that counts twice is off by 0.75.
            EXPECT_NEAR(world.reaction(0).y / force, 1,
                        has_loop                         ? 5e-2
                        : precision == Precision::single ? 1e-4
                                                         : 1e-9)
                << to_string(gradient) << " " << links << has_loop << " step " << i;
          }
        }
}

TEST(Reactions, BalanceIslandsWithLoopsAndAllElements) {
  Scene scene = hammock(4, 0);
  scene.particles.back().fixed = false;
  scene.particles.back().mass = 0.3;
  scene.particles.push_back(fixed({0, 1, 0}));
  scene.bends = {{.a = 0, .b = 1, .c = 2, .stiffness = 0.5}, {.a = 1, .b = 2, .c = 3, .stiffness = 0.5}};
  scene.tackles = {{.particles = {5, 2, 5, 4}, .law = {.stiffness = 40}}};
  scene.twists = {{.particles = {0, 1, 2, 3, 4}, .stiffness = 0.4, .angle = 2}};
  EXPECT_LT(
      imbalance(scene, {.method = Method::direct, .gradient = Gradient::mid, .tensions = true}, 200, {}),
      1e-8);
}

TEST(Reactions, AClampHoldsABeamByACouple) {
  Scene scene;
  scene.particles = {fixed({-0.1, 0, 0}), fixed({})};
  for (std::uint32_t i = 1; i <= 5; ++i) {
    scene.particles.push_back(movable({0.1 * i, 0, 0}, 0.01));
    scene.rods.push_back({.a = i, .b = i + 1});
    scene.bends.push_back({.a = i - 1, .b = i, .c = i + 1, .stiffness = 100, .damping = 1});
  }
  scene.drag = 20;
  World world(scene, {.tensions = true});
  test::run(world, 1.0 / 60, 1200);
  EXPECT_LT(norm(sum_of_reactions(world) - Vec3{0, 0.05 * g, 0}), 1e-6);
  // Forces 0.1 m apart hold the moment of the beam's weight about the clamp.
  double moment = 0;
  for (std::uint32_t i = 2; i < 7; ++i) moment += world.position(i).x * 0.01 * g;
  EXPECT_NEAR(world.reaction(0).y * 0.1, -moment, 1e-6);
}

TEST(Reactions, OnesThatAreNotKnownAreRefusedOrNotANumber) {
  const Scene scene = hammock(3, 0);
  World silent(scene, {.method = Method::direct});
  EXPECT_EQ(test::refusal([&] { (void)silent.reaction(0); }),
            "tensions are not known: Settings::tensions asks for them");
  World world(scene, {.method = Method::direct, .tensions = true});
  EXPECT_EQ(test::refusal([&] { (void)world.reaction(1); }), "particle 1: is movable, nothing holds it");
  EXPECT_TRUE(std::isnan(world.reaction(0).y)) << "before the first step";
  std::vector<Vec3> few(2);
  EXPECT_EQ(test::refusal([&] { world.copy_reactions(few); }),
            "reactions of 4 particles cannot be copied into 2 elements");
}

TEST(Reactions, ALoadOnAnAnchorIsHeldThere) {
  Scene scene = hammock(3, 0);
  World world(scene, {.method = Method::direct, .tensions = true});
  world.step(0.001);
  const Vec3 before = world.reaction(0);
  world.set_load([](const LoadState&, std::span<Vec3> forces) { forces[0] += Vec3{0, -7, 0}; });
  World other(scene, {.method = Method::direct, .tensions = true});
  other.set_load([](const LoadState&, std::span<Vec3> forces) { forces[0] += Vec3{0, -7, 0}; });
  other.step(0.001);
  EXPECT_LT(norm(other.reaction(0) - before - Vec3{0, 7, 0}), 1e-12);
}

// A chain without laws that lies in lanes beside one with laws is read as well as alone.
TEST(Tensions, AreKnownBesideChainsWithLaws) {
  for (const RodLaw& law : {RodLaw{.strength = 1e9}, RodLaw{.stiffness = 1e6}, RodLaw{.one_sided = true}}) {
    Scene scene;
    for (std::uint32_t i = 0; i < 3; ++i) {
      scene.particles.push_back(fixed({1.0 * i, 0, 0}));
      scene.particles.push_back(movable({1.0 * i, -1, 0}, 2));
      scene.rods.push_back({.a = 2 * i, .b = 2 * i + 1});
    }
    scene.rods[1].law = law;
    World world(scene, {.method = Method::direct, .gradient = Gradient::mid, .tensions = true, .threads = 1});
    world.step(1.0 / 60);
    for (const std::uint32_t i : {0u, 2u}) {
      EXPECT_NEAR(world.tension(i), 2 * g, 1e-9);
      EXPECT_NEAR(world.reaction(2 * i).y, 2 * g, 1e-9);
    }
  }
}

}  // namespace
}  // namespace plumb::PLUMB_TEST_FILE
