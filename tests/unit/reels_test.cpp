// Reels: what is refused, how a scene file keeps them, where they begin, and what measures see of them.

#include "scene/reels/reels.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <memory>
#include <string>
#include <vector>

#include "direct/loops/loop_elements.hpp"
#include "direct/reels/loop_reel.hpp"
#include "direct/reels/loop_reels.hpp"
#include "direct/reels/reel_view.hpp"
#include "plumb/plumb.hpp"
#include "scenes/files/scene_file.hpp"
#include "support/reeled_chain.hpp"
#include "support/refusals.hpp"
#include "support/worlds.hpp"

namespace plumb::PLUMB_TEST_FILE {
namespace {

using test::make_reeled;
using test::refusal;

template <class Change>
std::string refused(Change&& change) {
  Scene scene = make_reeled({.rods = 4, .length = 0.5});
  change(scene);
  return refusal([&] { validate(scene); });
}

TEST(ReelScenes, BadOnesAreRefusedWithTheirNumber) {
  const auto with = [](const Reel& reel) { return refused([&](Scene& s) { s.reels = {reel}; }); };
  EXPECT_EQ(with({{0}}), "reel 0: needs a drum and one particle at least, got 1 particles");
  EXPECT_EQ(with({{0, 1, 9}}), "reel 0: particle 9 does not exist (the scene has 5 particles)");
  EXPECT_EQ(with({{0, 1, 0}}), "reel 0: has particle 0 twice");
  EXPECT_EQ(with({{1, 2, 3}}), "reel 0: its drum, particle 1, is not fixed");
  EXPECT_EQ(with({{0, 2, 3}}), "reel 0: no rod joins particles 0 and 2");
  EXPECT_EQ(with({{0, 1, 2}, -1}), "reel 0: what is out must be finite and not negative, got -1 m");
  EXPECT_EQ(with({{0, 1, 2}, NAN}), "reel 0: what is out must be finite and not negative, got nan m");
  EXPECT_EQ(with({{0, 1, 2}, 1.5}), "reel 0: 1.5 m are out, but its chain is 1 m long");
  EXPECT_EQ(with({{0, 1, 2, 3, 4}}), "");
  EXPECT_EQ(refused([](Scene& s) { s.particles[4].fixed = true; }),
            "reel 0: particle 4 is fixed, but only the drum may be");
  EXPECT_EQ(refused([](Scene& s) { s.rods[1].mass = 1; }),
            "reel 0: rod 1 has mass, but a rope that is reeled has it in its particles");
  EXPECT_EQ(refused([](Scene& s) { s.rods[2].law.strength = 5; }),
            "reel 0: rod 2 has a strength, but rods that are reeled do not break");
}

TEST(ReelScenes, WhatHoldsAParticleThatMayBeWoundIsRefused) {
  EXPECT_EQ(refused([](Scene& s) {
              s.reels.push_back({{0, 1}});
            }),
            "reel 0: particle 1 may be wound, but another reel holds it");
  EXPECT_EQ(refused([](Scene& s) {
              s.reels.push_back({{0, 1, 2}});
            }),
            "reel 0: particle 1 may be wound, but reel 1 holds it");
  EXPECT_EQ(refused([](Scene& s) { s.rods.push_back({.a = 1, .b = 3}); }),
            "reel 0: particle 1 may be wound, but rod 4 holds it");
  EXPECT_EQ(refused([](Scene& s) { s.bends.push_back({.a = 1, .b = 2, .c = 3, .stiffness = 1}); }),
            "reel 0: particle 1 may be wound, but bend 0 holds it");
  EXPECT_EQ(refused([](Scene& s) {
              s.twists.push_back({.particles = {2, 3, 4}, .stiffness = 1});
            }),
            "reel 0: particle 2 may be wound, but twist 0 holds it");
  EXPECT_EQ(refused([](Scene& s) {
              s.tackles.push_back({.particles = {0, 3}});
            }),
            "reel 0: particle 3 may be wound, but tackle 0 holds it");
  EXPECT_EQ(refused([](Scene& s) {
              s.tackles.push_back({.particles = {0, 4}});
            }),
            "")
      << "the last particle is never wound";
}

TEST(ReelScenes, MethodsThatDoNotMoveThemRefuseThem) {
  const Scene scene = make_reeled({});
  const auto with = [&](const Settings& settings) { return refusal([&] { World world(scene, settings); }); };
  for (const Method method : {Method::relax, Method::springs, Method::multipliers, Method::featherstone})
    EXPECT_EQ(with({.method = method}),
              "reel 0: method " + std::string(to_string(method)) + " moves no reels; direct and auto do");
  EXPECT_EQ(with({.method = Method::direct, .gradient = Gradient::old}),
            "reel 0: gradient old moves no reels; mid and new do");
  Scene solid = scene;
  solid.capsules = {{.a = point_at(1), .b = point_at(1), .radius = 0.1}};
  EXPECT_EQ(refusal([&] { World world(solid); }),
            "reel 0: its island has joints or shapes, which nothing moves together with it yet");
  EXPECT_TRUE(has_more_than_rods(scene));
}

TEST(ReelScenes, AWorldRefusesUnknownOnesAndBadLengths) {
  World world(make_reeled({.rods = 4, .length = 0.5}));
  EXPECT_EQ(refusal([&] { world.set_reel(1, 1); }), "reel 1: unknown, the world has 1 reel");
  EXPECT_EQ(refusal([&] { (void)world.reel_out(1); }), "reel 1: unknown, the world has 1 reel");
  EXPECT_EQ(refusal([&] { world.set_reel(0, 0); }), "reel 0: a length must be positive and finite, got 0 m");
  EXPECT_EQ(refusal([&] { world.set_reel(0, 2.1); }), "reel 0: 2.1 m cannot be out of a chain of 2 m");
  EXPECT_EQ(refusal([&] { world.set_length(2, 0.4); }),
            "rod 2: its length cannot change by itself, since it is on a reel");
  EXPECT_EQ(world.reel_out(0), 2);
  world.set_reel(0, 1.25);
  EXPECT_EQ(world.reel_out(0), 2) << "until the next step";
  world.step(0.5);
  EXPECT_EQ(world.reel_out(0), 1.25);
}

TEST(ReelScenes, ASceneFileKeepsEveryBitOfThem) {
  Scene scene = make_reeled({.rods = 4, .length = 0.5, .out = 4.0 / 3});
  const Scene back = scenes::parse_scene(scenes::format_scene(scene), "f.json");
  ASSERT_EQ(back.reels.size(), 1u);
  EXPECT_EQ(back.reels[0].particles, scene.reels[0].particles);
  EXPECT_EQ(back.reels[0].out, scene.reels[0].out);
  scene.reels[0].out = 0;
  EXPECT_EQ(scenes::format_scene(scene).find("out"), std::string::npos) << "it is the default";
  const auto message = [](const std::string& reel) {
    return refusal([&] {
      scenes::parse_scene(R"({"plumb": 1, "particles": [{"position": [0, 0, 0], "fixed": true}], "rods": [],
                              "reels": [)" +
                              reel + "]}",
                          "f.json");
    });
  };
  EXPECT_EQ(message("{}"), "f.json: reels[0].particles is missing");
  EXPECT_EQ(message(R"({"particles": [0], "length": 2})"),
            "f.json: reels[0].length is not a known key; known are particles, out");
  EXPECT_EQ(message(R"({"particles": [0]})"),
            "f.json: reel 0: needs a drum and one particle at least, got 1 particles");
}

TEST(ReelScenes, BeginWithTheParticlesFreeThatAreHalfARodOut) {
  const auto first = [](double out) {
    const Scene scene = make_reeled({.rods = 4, .length = 0.5, .out = out});
    const detail::ReelStart start = detail::start_of(scene, detail::RodTable(scene), scene.reels[0]);
    EXPECT_EQ(start.out, out != 0 ? out : 2);
    EXPECT_EQ(start.behind, (Array<double>{2, 1.5, 1, 0.5, 0}));
    return start.first;
  };
  EXPECT_EQ(first(0), 1u);
  EXPECT_EQ(first(2), 1u);
  EXPECT_EQ(first(1.75), 1u);
  EXPECT_EQ(first(1.74), 2u);
  EXPECT_EQ(first(0.75), 3u);
  EXPECT_EQ(first(0.1), 4u);
}

TEST(ReelScenes, WoundRodsHaveNoStrainAndLieAtTheDrum) {
  const Scene scene = make_reeled({.rods = 4, .length = 0.5, .direction = {0.6, -0.8, 0}, .out = 1.1});
  World world(scene, {.method = Method::direct, .tensions = true});
  world.step(0.01);
  EXPECT_EQ(world.position(1), Vec3{});
  EXPECT_NEAR(norm(world.position(2)), 0.1, 1e-12) << "on the line to the first that is free";
  EXPECT_NEAR(norm(world.position(3)), 0.6, 1e-12);
  EXPECT_NEAR(norm(world.velocity(2)), norm(world.velocity(3)) / 6, 1e-12);
  EXPECT_EQ(world.tension(0), 0);
  EXPECT_EQ(world.tension(1), 0);
  EXPECT_GT(world.tension(2), 0);
  for (std::uint32_t rod = 0; rod < 4; ++rod) EXPECT_FALSE(world.is_broken(rod));
  EXPECT_TRUE(world.problems(1e-9).empty());
  EXPECT_LT(test::stretch_of(scene, world).max, 1e-12);
  EXPECT_EQ(detail::rods_at_drums(scene, test::positions_of(world)), (Array<std::uint8_t>{1, 1, 1, 0}));
  EXPECT_EQ(detail::reeled_rods(scene), (Array<std::uint8_t>{1, 1, 1, 1}));
  world.move_anchor(0, {0.1, 0.2, 0});
  world.step(0.01);
  EXPECT_EQ(world.position(1), (Vec3{0.1, 0.2, 0})) << "with the drum";
}

TEST(ReelScenes, StartsThatDoNotFitAreBroughtToTheirLengths) {
  Scene scene = make_reeled({.rods = 4, .length = 0.5, .out = 1.3});
  for (Particle& particle : scene.particles)
    if (!particle.fixed) particle.position = 1.02 * particle.position + Vec3{0.01, 0, 0};
  World world(scene, {.method = Method::direct});
  EXPECT_EQ(world.info().unprojected_islands, 0u);
  EXPECT_GT(world.info().projected_position, 0.005);
  EXPECT_TRUE(world.problems(1e-9).empty());
}

TEST(LoopReel, IsOrderedByWhatItHasAndAnElementOfItsIsland) {
  const detail::LoopReel one{{4, 0, 1}, {0, 1}}, other{{4, 0, 2}, {0, 1}};
  EXPECT_TRUE(one == one && one < other);
  detail::LoopElements elements;
  EXPECT_FALSE(elements.any());
  elements.reels = {one};
  EXPECT_TRUE(elements.any());
}

TEST(ReelView, CornersFadeFromWhatTheyBeginWith) {
  const Scene scene = make_reeled({.rods = 2, .length = 1});
  const Array<detail::LoopRod> rods{{0, 2}, {1, 0}};
  auto topology = std::make_shared<detail::LoopTopology>(2, 3, rods);
  topology->reels = {{{2, 0, 1}, {0, 1}}};
  detail::LoopState state(topology);
  state.length2 = {1, 1};
  state.hold.resize(1);
  const std::vector<std::uint32_t> numbers{0};
  detail::load_reels(state, scene, numbers);
  state.reels[0].corner = 0.1;
  state.reels[0].corner_slope = 0.3;
  state.reels[0].span = 0.5;
  const detail::ReelView reel(state, 0);
  EXPECT_DOUBLE_EQ(reel.corner(0), 0.1);
  EXPECT_EQ(reel.corner(0.5), 0);
  EXPECT_DOUBLE_EQ(reel.corner_slope(0), 0.3);
  for (const double turned : {0.1, 0.25, 0.4})
    EXPECT_NEAR((reel.corner(turned + 1e-6) - reel.corner(turned - 1e-6)) / 2e-6, reel.corner_slope(turned),
                1e-8);
  EXPECT_NEAR(reel.length_after(0), 0.9, 1e-15) << "two metres, one rod and the corner less";
}

}  // namespace
}  // namespace plumb::PLUMB_TEST_FILE
