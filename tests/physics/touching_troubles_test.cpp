// What goes wrong where things touch is told of the islands that it is of (World::problems(),
// World::events()).

#include <gtest/gtest.h>

#include <algorithm>
#include <cstdint>
#include <vector>

#include "plumb/plumb.hpp"
#include "support/bodies.hpp"
#include "support/snapshots.hpp"
#include "support/worlds.hpp"

namespace plumb::PLUMB_TEST_FILE {
namespace {

std::uint32_t append_ball(Scene& scene, Vec3 center, double mass = 1) {
  MassProperties ball = solid_sphere(mass, 0.1);
  ball.center = center;
  const std::uint32_t body = add_body(scene, ball);
  scene.capsules.push_back(sphere_at(point_on_body(scene, body, center), 0.1));
  return body;
}

std::vector<std::uint32_t> particles_with(std::span<const Problem> problems, Problem::Kind kind) {
  std::vector<std::uint32_t> out;
  for (const Problem& each : problems)
    if (each.kind == kind) out.push_back(each.particle);
  return out;
}

std::vector<std::uint32_t> particles_with(std::span<const Event> events, Event::Kind kind) {
  std::vector<std::uint32_t> out;
  for (const Event& each : events)
    if (each.kind == kind) out.push_back(each.particle);
  return out;
}

using Particles = std::vector<std::uint32_t>;

// A straight net cannot carry a ball without strain. The ball has none, nor has what lies beside.
TEST(TouchingTroubles, AreToldOfTheNetThatGives) {
  constexpr std::uint32_t n = 6;
  constexpr double apart = 0.1;
  Scene scene;
  append_ball(scene, {0.25, 0.13, 0.25});
  const auto first = static_cast<std::uint32_t>(scene.particles.size());
  const auto add_rod = [&](std::uint32_t a, std::uint32_t b) {
    scene.rods.push_back({.a = a, .b = b});
    scene.capsules.push_back({.a = point_at(a), .b = point_at(b), .radius = 0.02});
  };
  for (std::uint32_t i = 0; i < n; ++i)
    for (std::uint32_t j = 0; j < n; ++j) {
      const bool is_held = (i == 0 || i + 1 == n) && (j == 0 || j + 1 == n);
      const std::uint32_t at = first + i * n + j;
      scene.particles.push_back({.position = {apart * i, 0, apart * j}, .mass = 0.05, .fixed = is_held});
      if (j > 0) add_rod(at - 1, at);
      if (i > 0) add_rod(at - n, at);
    }
  scene.planes.push_back({.normal = {0, 1, 0}, .offset = -2});
  append_ball(scene, {3, -1.8, 0});
  World world(scene, {.events = true, .threads = 1});
  const Particles net{first + 1};
  int gave = 0;
  for (std::uint32_t k = 0, awake = 1; awake > 0; ++k) {
    ASSERT_LT(k, 600u) << "it never sleeps";
    const StepReport report = world.step(test::frame);
    awake = report.awake_islands;
    const bool gives = report.elastic_substeps > 0;
    gave += gives ? 1 : 0;
    EXPECT_EQ(particles_with(world.problems(), Problem::Kind::elastic), gives ? net : Particles{}) << k;
    EXPECT_EQ(particles_with(world.events(), Event::Kind::elastic), gives && awake > 0 ? net : Particles{});
  }
  EXPECT_GT(gave, 10);
  World restored(scene, {.events = true, .threads = 1});
  restored.restore(test::snapshot_of(world));
  for (World* const asleep : {&world, &restored}) {
    asleep->step(test::frame);
    EXPECT_EQ(particles_with(asleep->problems(), Problem::Kind::elastic), net) << "it lasts through sleep";
    EXPECT_TRUE(asleep->events().empty());
  }
}

// A ball that a force throws out of the numbers stands still. It is told once, and stays a problem.
TEST(TouchingTroubles, AreToldOfTheBallThatFreezes) {
  for (const Method method : {Method::automatic, Method::direct, Method::relax}) {
    Scene scene;
    scene.planes.push_back({.normal = {0, 1, 0}});
    append_ball(scene, {0, 0.1, 0});
    const std::uint32_t thrown = append_ball(scene, {3, 0.1, 0}, 1e-8);
    World world(scene, {.method = method, .events = true, .threads = 1});
    test::run(world, test::frame, 5);
    const std::uint32_t particle = scene.bodies[thrown].particles[0];
    world.set_force(particle, {0, 1.7e308, 0});
    for (int k = 0; world.step(test::frame).frozen_islands == 0; ++k) ASSERT_LT(k, 9) << to_string(method);
    EXPECT_EQ(particles_with(world.problems(), Problem::Kind::frozen), Particles{particle});
    EXPECT_EQ(particles_with(world.events(), Event::Kind::frozen), Particles{particle});
    world.step(test::frame);
    EXPECT_EQ(particles_with(world.problems(), Problem::Kind::frozen), Particles{particle});
    EXPECT_TRUE(particles_with(world.events(), Event::Kind::frozen).empty()) << "told again";
  }
}

// Work is spent on islands together. The first of those that touch stands for all, and others do not.
TEST(TouchingTroubles, AreToldOnceOfAHeap) {
  Scene scene;
  scene.planes.push_back({.normal = {0, 1, 0}});
  const std::uint32_t alone = append_ball(scene, {5, 0.1, 0});
  const std::uint32_t lowest = append_ball(scene, {0, 0.1, 0});
  for (int i = 1; i < 6; ++i) append_ball(scene, {0.05 * (i % 2), 0.1 + 0.15 * i, 0.03 * i});
  World world(scene, {.substeps = 4, .most_work = 12, .events = true, .threads = 1});
  std::uint64_t capped = 0;
  for (int k = 0; k < 20; ++k) {
    const bool is_capped = world.step(test::frame).capped_steps > 0;
    capped += is_capped ? 1 : 0;
    const Particles first{scene.bodies[lowest].particles[0]};
    EXPECT_EQ(particles_with(world.problems(), Problem::Kind::capped), is_capped ? first : Particles{}) << k;
    EXPECT_EQ(particles_with(world.events(), Event::Kind::capped), is_capped ? first : Particles{}) << k;
  }
  EXPECT_GT(capped, 0u) << scene.bodies[alone].particles[0];
}

}  // namespace
}  // namespace plumb::PLUMB_TEST_FILE
