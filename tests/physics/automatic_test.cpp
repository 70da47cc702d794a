#include <gtest/gtest.h>

#include <cmath>
#include <cstdint>
#include <optional>
#include <utility>

#include "scenes/generators/generators.hpp"
#include "scenes/spec.hpp"
#include "support/bodies.hpp"
#include "support/worlds.hpp"

namespace plumb::PLUMB_TEST_FILE {
namespace {

Settings automatic() {
  return {.method = Method::automatic};
}

// Whatever can be factorised is solved directly, and what is too wide for that is relaxed.
TEST(Automatic, PicksByShape) {
  const auto direct_rods = [](const char* spec) {
    const Scene scene = scenes::load_scene(spec);
    const World world(scene, automatic());
    const WorldInfo& info = world.info();
    EXPECT_EQ(info.direct_rods + info.relaxed_rods, scene.rods.size()) << spec;
    return info.direct_rods;
  };
  EXPECT_EQ(direct_rods("chain:links=2000"), 2000u);
  EXPECT_EQ(direct_rods("ensemble:chains=20,links=8"), 160u);
  EXPECT_GT(direct_rods("ring"), 0u);
  EXPECT_GT(direct_rods("truss:bays=30"), 0u);
  EXPECT_GT(direct_rods("net:width=40,height=40"), 0u);
  EXPECT_EQ(direct_rods("net:width=400,height=400"), 0u);
}

// Relaxation cannot represent the mass of a rod, so heavy rods are solved directly, however wide the island.
// This one is a star with one loop, as wide as it is large.
TEST(Automatic, SolvesRodsWithMassDirectly) {
  Scene scene;
  scene.particles.push_back(test::fixed({0, 1, 0}));
  scene.particles.push_back(test::movable({0, 0, 0}));
  scene.rods.push_back({.a = 0, .b = 1});
  for (std::uint32_t i = 2; i < 1000; ++i) {
    scene.particles.push_back(test::movable({std::cos(0.01 * i), 0, std::sin(0.01 * i)}));
    scene.rods.push_back({.a = 1, .b = i});
  }
  scene.rods.push_back({.a = 2, .b = 3});
  EXPECT_EQ(World(scene, automatic()).info().direct_rods, 0u);
  scene.rods.front().mass = 0.5;
  EXPECT_EQ(World(scene, automatic()).info().relaxed_rods, 0u);
  Settings lumped = automatic();
  lumped.mass = MassModel::lumped;
  EXPECT_EQ(World(scene, lumped).info().direct_rods, 0u);
}

TEST(Automatic, ChoosesGradients) {
  Settings settings = automatic();
  const auto chosen = [&](const Scene& scene) {
    const WorldInfo info = World(scene, settings).info();
    return std::pair{info.direct_gradient, info.changes_gradient};
  };
  const Scene net = scenes::load_scene("net:width=6,height=6");
  Scene heavy_net = net;
  for (Rod& rod : heavy_net.rods) rod.mass = 0.1;
  EXPECT_EQ(chosen(scenes::make_rods5()), (std::pair{Gradient::mid, false}));
  settings.accuracy = 1e-2;
  EXPECT_EQ(chosen(scenes::make_chain(5)), (std::pair{Gradient::old, true}));
  EXPECT_EQ(chosen(scenes::make_rods5()), (std::pair{Gradient::old, true}));
  EXPECT_EQ(chosen(scenes::make_chain(100)), (std::pair{Gradient::old, false})) << "cut into segments";
  EXPECT_EQ(chosen(net), (std::pair{Gradient::old, false}));
  EXPECT_EQ(chosen(heavy_net), (std::pair{Gradient::mid, false}));
  settings.accuracy = 1e-6;  // order 4
  EXPECT_EQ(chosen(scenes::make_rods5()), (std::pair{Gradient::old, false}));
  settings.accuracy = 1e-2;
  for (const Gradient gradient : {Gradient::new_, Gradient::old, Gradient::mid}) {
    settings.gradient = gradient;
    EXPECT_EQ(chosen(scenes::make_chain(5)), (std::pair{gradient, false}));
  }
}

/// Substeps of six seconds with method automatic and an accuracy of 0.1.
std::uint64_t substeps_of(const Scene& scene, std::optional<Gradient> gradient = {}) {
  Settings settings = automatic();
  settings.accuracy = 0.1;
  settings.gradient = gradient;
  World world(scene, settings);
  std::uint64_t substeps = 0;
  for (int i = 0; i < 360 && substeps < 500'000; ++i) substeps += world.step(1.0 / 60).direct_substeps;
  return substeps;
}

// Rods with mass and a heavy end, level at first, whip: gradient mid follows ever more closely what its long
// steps made of fast motion (514,000 substeps; 61,000 of old, 91,000 of automatic). Hanging still, such a
// chain needs none but that old stays stable (27,000; automatic 600).
TEST(Automatic, TakesTheGradientThatAMotionNeeds) {
  Scene scene = scenes::make_chain(5, 0.1, 100);
  for (std::size_t i = 1; i < 5; ++i) scene.particles[i].mass = 0;
  for (Rod& rod : scene.rods) rod.mass = 0.1;
  EXPECT_LT(substeps_of(scene), 250'000u);
  for (Particle& particle : scene.particles) particle.position = {0, -particle.position.x, 0};
  const std::uint64_t still = substeps_of(scene);
  EXPECT_LT(still, 720u);
  EXPECT_GT(substeps_of(scene, Gradient::old), 5 * still);
}

/// A chain and a net that hang from one and the same fixed particle, and a fixed particle that holds nothing.
/// The net is so vast that it is relaxed.
struct Mixed {
  Scene scene;
  std::uint32_t chain_begin, chain_end;
};
Mixed mixed() {
  Mixed out{scenes::load_scene("net:width=320,height=320"), 0, 0};
  Scene& scene = out.scene;
  std::uint32_t fixed = 0;
  while (!scene.particles[fixed].fixed) ++fixed;
  std::uint32_t last = fixed;
  out.chain_begin = static_cast<std::uint32_t>(scene.particles.size());
  for (int i = 1; i <= 6; ++i) {
    scene.particles.push_back(test::movable(scene.particles[fixed].position + Vec3{0, 0, 0.1 * i}));
    scene.rods.push_back({.a = last, .b = static_cast<std::uint32_t>(scene.particles.size() - 1)});
    last = scene.rods.back().b;
  }
  out.chain_end = last + 1;
  scene.particles.push_back(test::fixed({5, 5, 5}));
  return out;
}

// Islands that move by different methods do not notice each other: each part is what it would be in a world
// of its own, bit for bit, with forces and a moved anchor that both hang from.
TEST(Automatic, PartsMoveAsTheyDoAlone) {
  const Mixed both = mixed();
  World world(both.scene, automatic());
  EXPECT_EQ(world.info().direct_rods, 6u);
  EXPECT_EQ(world.info().relaxed_rods, both.scene.rods.size() - 6);
  EXPECT_EQ(world.info().islands, 2u);

  Scene net = scenes::load_scene("net:width=320,height=320");
  std::uint32_t fixed = 0;
  while (!net.particles[fixed].fixed) ++fixed;
  World relaxed(net, {.method = Method::relax});
  Scene chain;
  chain.particles.push_back(net.particles[fixed]);
  for (std::uint32_t i = both.chain_begin; i < both.chain_end; ++i) {
    chain.particles.push_back(both.scene.particles[i]);
    chain.rods.push_back({.a = i - both.chain_begin, .b = i - both.chain_begin + 1});
  }
  World direct(chain, {.method = Method::direct});

  for (int i = 0; i < 20; ++i) {
    if (i == 7) {
      const Vec3 target = net.particles[fixed].position + Vec3{0.02, 0, 0.01};
      world.move_anchor(fixed, target);
      relaxed.move_anchor(fixed, target);
      direct.move_anchor(0, target);
      world.set_force(both.chain_end - 1, {1, 2, 3});
      direct.set_force(6, {1, 2, 3});
    }
    for (World* each : {&world, &relaxed, &direct}) each->step(1.0 / 60);
  }
  for (std::uint32_t i = 0; i < net.particles.size(); ++i) {
    EXPECT_EQ(world.position(i), relaxed.position(i));
    EXPECT_EQ(world.velocity(i), relaxed.velocity(i));
  }
  for (std::uint32_t i = both.chain_begin; i < both.chain_end; ++i) {
    EXPECT_EQ(world.position(i), direct.position(i - both.chain_begin + 1));
    EXPECT_EQ(world.velocity(i), direct.velocity(i - both.chain_begin + 1));
  }
  EXPECT_EQ(world.position(both.chain_end), (Vec3{5, 5, 5}));
}

// A long line moves in segments. With a side branch of next to no mass it is a tree, which the general kernel
// solves as a whole, and the same motion: 1e-12 of the mass moves it by less than the tolerances.
TEST(Automatic, SegmentsAreTheWholeLine) {
  for (const std::uint32_t links : {64u, 65u, 100u, 333u}) {
    const Scene line = scenes::make_chain(links, 0.1, 10);
    Scene tree = line;
    tree.particles.push_back(test::movable(line.particles[1].position + Vec3{0, 0, 0.1}, 1e-12));
    tree.rods.push_back({.a = 1, .b = links + 1});
    const Settings old{.method = Method::direct, .gradient = Gradient::old, .substeps = 8};
    World segments(line, old), whole(tree, old);
    test::run(segments, 1.0 / 60, 15);
    test::run(whole, 1.0 / 60, 15);
    for (std::uint32_t i = 0; i <= links; ++i) {
      EXPECT_LE(norm(segments.position(i) - whole.position(i)), 1e-8) << links << ", particle " << i;
      EXPECT_LE(norm(segments.velocity(i) - whole.velocity(i)), 1e-6) << links << ", particle " << i;
    }
    EXPECT_LE(test::stretch_of(line, segments).max, 1e-10);
  }
}

// Thirty-six sticks fall on as many that lie across them, all in one step. It is relaxed as soon as so many
// press, as the steps after it are: a heap of figures would else take seconds for that step.
TEST(Automatic, RelaxesWhatLandsOnEachOtherAtOnce) {
  constexpr int side = 6;
  constexpr double radius = 0.05, half = 0.2, speed = 3;
  Scene scene;
  scene.planes.push_back({});
  for (int i = 0; i < side * side; ++i)
    for (const bool is_upper : {false, true}) {
      const Vec3 along = is_upper ? Vec3{half, 0, 0} : Vec3{0, 0, half};
      const Vec3 middle{0.5 * (i % side), is_upper ? 3 * radius + 0.5 * speed / 60 : radius,
                        0.5 * (i / side)};
      const std::uint32_t rod = test::add_capsule_rod(scene, middle - along, middle + along, 1, radius);
      for (const std::uint32_t end : {scene.rods[rod].a, scene.rods[rod].b})
        scene.particles[end].velocity = is_upper ? Vec3{0, -speed, 0} : Vec3{};
    }
  World picks(scene, automatic());
  const StepReport relaxed = picks.step(1.0 / 60);
  EXPECT_GE(relaxed.contact_points, 36u);
  EXPECT_EQ(relaxed.newton, 0u);
  EXPECT_GE(relaxed.block_sweeps, 4u * 20u) << "four substeps of twenty sweeps";
  EXPECT_LE(test::stretch_of(scene, picks).max, 1e-6);
  EXPECT_LE(test::deepest(scene, picks), 1e-3);
}

}  // namespace
}  // namespace plumb::PLUMB_TEST_FILE
